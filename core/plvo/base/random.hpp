// SPDX-License-Identifier: Apache-2.0
// PCG32 (O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random
// Number Generation", 2014; the XSH-RR 64/32 member). It uses integers only, so the sequence is the same on
// every machine.
#pragma once

#include <cstdint>

namespace plvo {

class Random {
 public:
  constexpr explicit Random(std::uint64_t seed = 1, std::uint64_t stream = 1)
      : state_(0), increment_((stream << 1) | 1) {
    next();
    state_ += seed;
    next();
  }

  // Uniform over all 32-bit integers.
  constexpr std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto rotation = static_cast<std::uint32_t>(old >> 59);
    return (shifted >> rotation) | (shifted << ((32 - rotation) & 31));
  }

  // Uniform over 0 … bound-1 (bound > 0). The multiply-shift map takes constant time; its bias is at most
  // bound / 2^32.
  constexpr std::uint32_t below(std::uint32_t bound) {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(next()) * bound) >> 32);
  }

  // Uniform over [0, 1), a multiple of 2^-32.
  constexpr double uniform() { return static_cast<double>(next()) * (1.0 / 4294967296.0); }

 private:
  std::uint64_t state_;
  std::uint64_t increment_;
};

}  // namespace plvo
