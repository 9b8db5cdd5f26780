// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/stamp_error.hpp"

namespace plvo {
namespace {

Matrix6 moved_by(const Vector6& rate, double sigma_s) {
  const Vector6 moved = sigma_s * rate;
  return moved.lazyProduct(moved.transpose());
}

// Rate of a transform out of the camera: the camera moves against the scene, so the sign changes.
Vector6 out_of_camera(const Matrix3& R, const Vector6& velocity) {
  Vector6 rate;
  rate.head<3>() = -(R * velocity.head<3>());
  rate.tail<3>() = -(R * velocity.tail<3>());
  return rate;
}

}  // namespace

Matrix6 stamp_covariance_of_pose(const Se3& T_world_camera, const Vector6& velocity, double stamp_sigma_s) {
  return moved_by(out_of_camera(T_world_camera.R, velocity), stamp_sigma_s);
}

Matrix6 stamp_covariance_of_motion(const Se3& T_current_reference, const Vector6& current_velocity,
                                   const Vector6& reference_velocity, double stamp_sigma_s) {
  Vector6 rate = current_velocity;
  rate.head<3>() += skew(current_velocity.tail<3>()) * T_current_reference.t;
  return moved_by(rate, stamp_sigma_s) +
         moved_by(out_of_camera(T_current_reference.R, reference_velocity), stamp_sigma_s);
}

void report_pose(const PoseWithCovariance& pose, const Vector6& velocity, double stamp_sigma_s,
                 TrackResult& result) {
  result.T_world_camera = pose.T_world_camera;
  result.pose_covariance =
      pose.total_covariance() + stamp_covariance_of_pose(pose.T_world_camera, velocity, stamp_sigma_s);
}

}  // namespace plvo
