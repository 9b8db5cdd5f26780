// SPDX-License-Identifier: Apache-2.0
// The size of a matrix as an algorithm receives it. By default it is a constant, so the compiler generates
// separate code for each size. In size-optimised code it is a number, so one function serves all sizes. The
// order of operations is the same.
#pragma once

#include <type_traits>

#include "plvo/base/build.hpp"

namespace plvo {

template <int N>
constexpr auto matrix_size() {
  if constexpr (kSizeOptimised)
    return N;
  else
    return std::integral_constant<int, N>{};
}

}  // namespace plvo
