// SPDX-License-Identifier: Apache-2.0
// What matches with the base err is mostly the same from one frame to the next: the landmarks are the same,
// with the same depths, seen in the same keyframe image. In the weighing of the base against a reference that
// was itself matched with that base it cancels, and C_H knows nothing of it; in the motion it does not,
// however many frames follow.
#pragma once

#include "plvo/math/types.hpp"

namespace plvo {

// What an estimate's references say of its motion, as information about T_current_base: H of the base, and of
// all others together.
struct ReferenceInformation {
  Matrix6 base = Matrix6::Zero();
  Matrix6 others = Matrix6::Zero();
};

// By how much C_H is too small. With J = H_base + H_others and K = J⁻¹ H_others the error is (I − K) e_base +
// K e_others. Of e_base, whose covariance is H_base⁻¹, a share is the same in every frame; e_others has
// H_others⁻¹ + D, where D is what this function said of the other references' pose, and holds the same share
// of e_base, as its own weights have always added up to one. In the basis T in which J = I and H_others is
// diagonal, with entries k (T Tᵀ = J⁻¹, K = T diag(k) T⁻¹, d = T⁻¹ D T⁻ᵀ), what is left out is
//
//   D' = T (diag(k) d diag(k) + diag(2 k min(share, √(share s (1 − k))))) Tᵀ,  s = 1 / k + d_ii.
//
// The first of the two is exact while the base says the same in every frame; the second is where the base
// knows so little (any more) that e_others, of variance s, cannot hold all of its share (Cauchy–Schwarz).
// Without others D' = 0, without a base D' = D; it is 0, too, where J has no inverse. Split covariance
// intersection (Julier & Uhlmann 2001) is the relative that does not know the weights.
Matrix6 common_mode_error(const ReferenceInformation& information, const Matrix6& D, double share);

}  // namespace plvo
