// SPDX-License-Identifier: Apache-2.0
// Effect of stamp errors on poses. A pose refers to the stamp of its frame, but the frame was not exposed
// exactly at that stamp: a moving camera is elsewhere at the stamp than its image shows.
// CameraModel::stamp_sigma_s is the SD of the stamps' errors, which are independent. The estimate relates
// exposures and does not depend on stamps. So this covariance is added to the reported ones only, never to
// those of the next estimate.
#pragma once

#include "plvo/odometry/track_result.hpp"
#include "plvo/odometry/window/pose_with_covariance.hpp"

namespace plvo {

// Velocities as in Exposure: (v, ω) per second, dX/dt = v + ω × X in the camera's frame. Covariances of
// ⊞-perturbations, to first order.
Matrix6 stamp_covariance_of_pose(const Se3& T_world_camera, const Vector6& velocity, double stamp_sigma_s);
// Includes the stamp errors of both frames.
Matrix6 stamp_covariance_of_motion(const Se3& T_current_reference, const Vector6& current_velocity,
                                   const Vector6& reference_velocity, double stamp_sigma_s);
// States a pose and its covariance, with the error of the stamp, in a result.
void report_pose(const PoseWithCovariance& pose, const Vector6& velocity, double stamp_sigma_s,
                 TrackResult& result);

}  // namespace plvo
