// SPDX-License-Identifier: Apache-2.0
// Two doubles side by side, in the vector types of GCC and Clang. Each of the two sees the same operations in
// the same order as if it were alone: the bits do not depend on whether a processor does both at once.
#pragma once

#include <cstring>

namespace plvo {

using Pair = double __attribute__((vector_size(16)));

inline __attribute__((always_inline)) void add_to(double* two, const Pair& pair) {
  Pair sum;
  std::memcpy(&sum, two, sizeof sum);
  sum += pair;
  std::memcpy(two, &sum, sizeof sum);
}

}  // namespace plvo
