// SPDX-License-Identifier: Apache-2.0
// Rounding without the C library, whose own follows the processor's rounding mode.
#pragma once

namespace plvo {

// The nearest integer, halves away from zero; it must fit.
template <typename Integer>
constexpr Integer round_to(double value) {
  return static_cast<Integer>(value < 0 ? value - 0.5 : value + 0.5);
}

}  // namespace plvo
