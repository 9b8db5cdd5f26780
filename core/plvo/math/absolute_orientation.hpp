// SPDX-License-Identifier: Apache-2.0
// The rotation that best aligns pairs of vectors, in closed form (Horn, "Closed-form solution of absolute
// orientation using unit quaternions", JOSA A 4(4), 1987). It solves [2] and [34] of the paper without an
// SVD.
#pragma once

#include "plvo/math/types.hpp"

namespace plvo {

// Returns the R that maximises Σ b_iᵀ R a_i, and hence minimises Σ |b_i − R a_i|², given correlation = Σ b_i
// a_iᵀ. R is always a proper rotation. If the pairs do not determine the rotation (all a_i parallel), R is
// one of the optimal ones.
Matrix3 best_rotation(const Matrix3& correlation);

}  // namespace plvo
