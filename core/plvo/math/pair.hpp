// SPDX-License-Identifier: Apache-2.0
// Two doubles in a SIMD vector, in the vector types of GCC and Clang. Each of the two undergoes the same
// operations in the same order as a scalar would. The results are therefore bit-identical whether or not the
// processor computes both at once.
#pragma once

namespace plvo {

using Pair = double __attribute__((vector_size(16)));

}  // namespace plvo
