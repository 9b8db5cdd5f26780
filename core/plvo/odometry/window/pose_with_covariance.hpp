// SPDX-License-Identifier: Apache-2.0
// The pose of a frame in the world, with its uncertainty.
#pragma once

#include "plvo/math/se3.hpp"

namespace plvo {

// A pose with its covariance, and with the cross-covariance of its error and those of gravity
// (gravity_filter.hpp).
struct PoseWithCovariance {
  Se3 T_world_camera;
  Matrix6 covariance = Matrix6::Zero();               // of the ⊞-perturbation
  Matrix6 covariance_with_gravity = Matrix6::Zero();  // rows as in covariance; columns (ε, β)
};

// Moves `from` by T_current_from, which has this covariance (of its ⊞-perturbation).
PoseWithCovariance advance(const PoseWithCovariance& from, const Se3& T_current_from,
                           const Matrix6& motion_covariance);

// ∂δ_current / ∂δ_from of advance().
Matrix6 derivative_of_advance(const PoseWithCovariance& from, const PoseWithCovariance& current);

// Brings the covariance within the bound and makes it valid again (covariance.hpp); a valid one stays the
// same bit by bit. Returns false where the pose or the covariance is not finite.
bool settle(PoseWithCovariance& pose);

}  // namespace plvo
