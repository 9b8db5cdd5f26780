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

}  // namespace plvo
