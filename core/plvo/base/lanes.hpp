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
  using Bytes = std::uint8_t __attribute__((vector_size(8)));
  Bytes eight;
  std::memcpy(&eight, bytes, sizeof eight);
  lanes = __builtin_convertvector(eight, Lanes);
}

}  // namespace plvo
