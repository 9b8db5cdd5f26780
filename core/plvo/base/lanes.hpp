// SPDX-License-Identifier: Apache-2.0
// Eight 16-bit integers side by side, in the vector types of GCC and Clang: one register where a processor
// has such, plain instructions where not, the same bits everywhere. Pass them by reference or inline: how
// they travel by value differs between boards.
#pragma once

#include <cstdint>
#include <cstring>

namespace plvo {

using Lanes = std::int16_t __attribute__((vector_size(16)));

// Of eight bytes in memory.
inline __attribute__((always_inline)) void load_bytes(const std::uint8_t* bytes, Lanes& lanes) {
#ifdef __SSE2__
  // Zeros between the bytes: one instruction, of the plain conversion GCC 12 makes five.
  using Bytes = std::uint8_t __attribute__((vector_size(16)));
  Bytes eight = {};
  std::memcpy(&eight, bytes, 8);
  const Bytes wide =
      __builtin_shufflevector(eight, Bytes{}, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  std::memcpy(&lanes, &wide, sizeof lanes);
#else
  using Bytes = std::uint8_t __attribute__((vector_size(8)));
  Bytes eight;
  std::memcpy(&eight, bytes, sizeof eight);
  lanes = __builtin_convertvector(eight, Lanes);
#endif
}

}  // namespace plvo
