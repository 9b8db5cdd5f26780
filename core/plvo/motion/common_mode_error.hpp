// SPDX-License-Identifier: Apache-2.0
// Common-mode error of the motion estimate. The errors of matches with the base are mostly the same from one
// frame to the next: the landmarks, their depths and the keyframe image do not change. This common error
// cancels when the base is weighed against a reference that was itself matched with the same base, so C_H
// does not contain it. It does not cancel in the motion, however many frames follow.
#pragma once

#include "plvo/math/types.hpp"

namespace plvo {

// Information of an estimate's references about T_current_base: H of the base, and the sum of H over all
// other references.
struct ReferenceInformation {
  Matrix6 base = Matrix6::Zero();
  Matrix6 others = Matrix6::Zero();
};

// Returns the covariance that C_H lacks. With J = H_base + H_others and K = J⁻¹ H_others the error is (I − K)
// e_base + K e_others. A fraction `share` of e_base, whose covariance is H_base⁻¹, is the same in every
// frame. The covariance of e_others is H_others⁻¹ + D, where D is the value that this function returned for
// the pose of the other references. e_others contains the same share of e_base, because its own weights have
// always added up to one. In the basis T in which J = I and H_others is diagonal, with entries k (T Tᵀ = J⁻¹,
// K = T diag(k) T⁻¹, d = T⁻¹ D T⁻ᵀ), the missing covariance is
//
//   D' = T (diag(k) d diag(k) + diag(2 k min(share, √(share s (1 − k))))) Tᵀ,  s = 1 / k + d_ii.
//
// The first argument of the minimum, the share, is exact while the information of the base is constant over
// the frames. The second one applies when the base has so little information (left) that e_others, of
// variance s, cannot contain all of its share (Cauchy–Schwarz). Without other references D' = 0; without a
// base D' = D. D' is also 0 if J is singular. Split covariance intersection (Julier & Uhlmann 2001) solves
// the related problem with unknown weights.
Matrix6 common_mode_error(const ReferenceInformation& information, const Matrix6& D, double share);

}  // namespace plvo
