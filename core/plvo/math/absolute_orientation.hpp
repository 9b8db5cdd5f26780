// SPDX-License-Identifier: Apache-2.0
// The rotation that best aligns pairs of vectors, in closed form (Horn, "Closed-form solution of absolute
// orientation using unit quaternions", JOSA A 4(4), 1987): the answer to [2] and [34] of the paper, without
// an SVD.
#pragma once

#include "plvo/math/types.hpp"

namespace plvo {

// R that maximises Σ b_iᵀ R a_i, hence minimises Σ |b_i − R a_i|², given correlation = Σ b_i a_iᵀ. Always a
// proper rotation. When the pairs leave the rotation open (all a_i parallel), it is one of the best ones.
Matrix3 best_rotation(const Matrix3& correlation);

}  // namespace plvo
