// SPDX-License-Identifier: Apache-2.0
// Rounding without the C library, whose functions follow the processor's rounding mode.
#pragma once

namespace plvo {

// Rounds to the nearest integer, halves away from zero. The result must fit in Integer.
template <typename Integer>
constexpr Integer round_to(double value) {
  return static_cast<Integer>(value < 0 ? value - 0.5 : value + 0.5);
}

}  // namespace plvo
