// SPDX-License-Identifier: Apache-2.0
// How an algorithm over matrices of several sizes is told theirs: as a constant, which makes code of its own
// for each, or, where code shall be small, as a number, which makes one for all. The order of its operations
// is the same.
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
