// SPDX-License-Identifier: Apache-2.0
// FNV-1a over the bits of numbers: two runs with the same value computed the same, to the last bit.
#pragma once

#include <cstdint>
#include <cstring>

#include "plvo/math/types.hpp"

namespace plvo {

class Fingerprint {
 public:
  void add(std::uint64_t bits) {
    for (int i = 0; i < 8; ++i) add_byte(static_cast<std::uint8_t>(bits >> (8 * i)));
  }
  void add_byte(std::uint8_t byte) { hash_ = (hash_ ^ byte) * 1099511628211ULL; }  // FNV-1a
  void add(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  void add(int value) { add(static_cast<std::uint64_t>(static_cast<std::int64_t>(value))); }
  template <int Rows, int Cols>
  void add(const Matrix<Rows, Cols>& m) {
    for (int r = 0; r < Rows; ++r)
      for (int c = 0; c < Cols; ++c) add(m(r, c));
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037ULL;
};

}  // namespace plvo
