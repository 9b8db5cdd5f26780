// SPDX-License-Identifier: Apache-2.0
// The pose of a frame in the world, with its uncertainty.
#pragma once

#include "plvo/motion/cost_term.hpp"

namespace plvo {

// A pose with its covariance, and with the cross-covariance of its error and those of gravity
// (gravity_filter.hpp).
struct PoseWithCovariance {
  Se3 T_world_camera;
  Matrix6 covariance = Matrix6::Zero();               // of the ⊞-perturbation
  Matrix6 covariance_with_gravity = Matrix6::Zero();  // rows as in covariance; columns (ε, β)
  // By how much the pose would differ if one kind of landmark had decided (MotionEstimate::shifts), a
  // ⊞-perturbation for each kind. What makes a kind disagree is the same from frame to frame. So these add up
  // along the way as they are, where the noise in `covariance` adds up by its squares.
  OfEachKind shifts = OfEachKind::Zero();

  // The covariance that is reported. It contains what each kind says.
  Matrix6 total_covariance() const { return covariance + shifts.lazyProduct(shifts.transpose()); }
};

// Moves `from` by T_current_from, which has this covariance and these shifts (of its ⊞-perturbation).
PoseWithCovariance advance(const PoseWithCovariance& from, const Se3& T_current_from,
                           const Matrix6& motion_covariance,
                           const OfEachKind& motion_shifts = OfEachKind::Zero());

// ∂δ_current / ∂δ_from of advance().
Matrix6 derivative_of_advance(const PoseWithCovariance& from, const PoseWithCovariance& current);
// ∂δ_current / ∂ξ of advance(), with T_current_from ⊞ ξ.
Matrix6 derivative_by_motion(const PoseWithCovariance& current, const Se3& T_current_from);

// Brings the covariance within the bound and makes it valid again (covariance.hpp); a valid one stays the
// same bit by bit. Returns false where the pose or the covariance is not finite.
bool settle(PoseWithCovariance& pose);

}  // namespace plvo
