// SPDX-License-Identifier: Apache-2.0
// A pose is that of its frame's stamp, and a stamp is not exactly when the frame was exposed: a camera that
// moves is elsewhere at the stamp than its image shows. CameraModel::stamp_sigma_s says by how much stamps
// err, each on its own. The estimate itself is between exposures and does not know of stamps, so this joins
// what is reported, and never what the next estimate is made with.
#pragma once

#include "plvo/math/se3.hpp"

namespace plvo {

// Velocities as of Exposure: (v, ω) per second, dX/dt = v + ω × X in the camera's frame. Covariances of
// ⊞-perturbations, to first order.
Matrix6 stamp_covariance_of_pose(const Se3& T_world_camera, const Vector6& velocity, double stamp_sigma_s);
// Both ends have a stamp.
Matrix6 stamp_covariance_of_motion(const Se3& T_current_reference, const Vector6& current_velocity,
                                   const Vector6& reference_velocity, double stamp_sigma_s);

}  // namespace plvo
