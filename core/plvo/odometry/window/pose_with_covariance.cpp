// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/window/pose_with_covariance.hpp"

#include "plvo/math/covariance.hpp"

namespace plvo {

Matrix6 derivative_by_motion(const PoseWithCovariance& current, const Se3& T_current_from) {
  const Matrix3& R = current.T_world_camera.R;
  Matrix6 B = rotation_of_both(-R);
  B.block<3, 3>(0, 3) = -R * skew(T_current_from.t);
  return B;
}

Matrix6 derivative_of_advance(const PoseWithCovariance& from, const PoseWithCovariance& current) {
  Matrix6 A = Matrix6::Identity();
  A.block<3, 3>(0, 3) = -skew(current.T_world_camera.t - from.T_world_camera.t);
  return A;
}

PoseWithCovariance advance(const PoseWithCovariance& from, const Se3& T_current_from,
                           const Matrix6& motion_covariance, const OfEachKind& motion_shifts) {
  PoseWithCovariance current;
  current.T_world_camera = from.T_world_camera * T_current_from.inverse();
  current.T_world_camera.R = renormalise(current.T_world_camera.R);
  const Matrix6 A = derivative_of_advance(from, current);
  const Matrix6 B = derivative_by_motion(current, T_current_from);
  current.covariance = transform_covariance(A, from.covariance) + transform_covariance(B, motion_covariance);
  current.covariance_with_gravity = A.lazyProduct(from.covariance_with_gravity);
  current.shifts = A.lazyProduct(from.shifts) + B.lazyProduct(motion_shifts);
  return current;
}

bool settle(PoseWithCovariance& pose) {
  Vector6 scale;
  if (!pose.T_world_camera.is_finite() || !pose.covariance_with_gravity.allFinite() ||
      !pose.shifts.allFinite() || !make_bounded_covariance(pose.covariance, &scale))
    return false;
  for (int i = 0; i < 6; ++i)
    if (scale[i] < 1) pose.covariance_with_gravity.row(i) *= scale[i];
  return true;
}

}  // namespace plvo
