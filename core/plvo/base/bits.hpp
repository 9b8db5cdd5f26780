// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace plvo {

// By parallel sums of neighbouring fields: std::popcount calls a function where a processor has no
// instruction for it.
constexpr int count_bits(std::uint64_t x) {
  x -= (x >> 1) & 0x5555555555555555ULL;
  x = (x & 0x3333333333333333ULL) + ((x >> 2) & 0x3333333333333333ULL);
  x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fULL;
  return static_cast<int>((x * 0x0101010101010101ULL) >> 56);
}

// The place of the lowest bit that is set, and of the highest; x is not 0, which the functions of <bit> must
// ask at every call.
constexpr int lowest_bit(unsigned x) { return __builtin_ctz(x); }
constexpr int highest_bit(unsigned x) { return static_cast<int>(8 * sizeof x) - 1 - __builtin_clz(x); }

}  // namespace plvo
