// SPDX-License-Identifier: Apache-2.0
// Two doubles side by side, in the vector types of GCC and Clang. Each of the two sees the same operations in
// the same order as if it were alone: the bits do not depend on whether a processor does both at once.
#pragma once

namespace plvo {

using Pair = double __attribute__((vector_size(16)));

}  // namespace plvo
