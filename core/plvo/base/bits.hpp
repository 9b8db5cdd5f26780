// SPDX-License-Identifier: Apache-2.0
// Bit operations that need few instructions on every processor.
#pragma once

#include <cstdint>

namespace plvo {

// Number of set bits, by parallel sums of adjacent fields. std::popcount calls a library function on
// processors without such an instruction.
constexpr int count_bits(std::uint64_t x) {
  x -= (x >> 1) & 0x5555555555555555ULL;
  x = (x & 0x3333333333333333ULL) + ((x >> 2) & 0x3333333333333333ULL);
  x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fULL;
  return static_cast<int>((x * 0x0101010101010101ULL) >> 56);
}

// Index of the lowest and of the highest set bit. x must not be 0; the functions of <bit> test for that at
// every call.
constexpr int lowest_bit(unsigned x) { return __builtin_ctz(x); }
constexpr int highest_bit(unsigned x) { return static_cast<int>(8 * sizeof x) - 1 - __builtin_clz(x); }

}  // namespace plvo
