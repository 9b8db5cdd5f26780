// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/robot_base.hpp"

#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

// A T B⁻¹, and the covariance of its ⊞-perturbation.
void between(const Se3& A, const Se3& B, Se3& T, Matrix6& covariance) {
  const Matrix6 exact = Matrix6::Zero();
  const Se3 B_inverse = B.inverse();
  const Se3 A_T = A * T;
  covariance = compose_covariance(A, exact, T, covariance);
  covariance = compose_covariance(A_T, covariance, B_inverse, exact);
  T = A_T * B_inverse;
}

}  // namespace

Matrix3 rotation_body_optical() {
  Matrix3 R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R;
}

TrackResult result_of_base(const TrackResult& result, const Se3& T_base_camera, const Se3& T_odom_world) {
  TrackResult base = result;
  between(T_odom_world, T_base_camera, base.T_world_camera, base.pose_covariance);
  between(T_base_camera, T_base_camera, base.T_camera_reference, base.motion_covariance);
  return base;
}

Se3 level_odom(const Se3& T_world_camera, const Se3& T_base_camera) {
  const Matrix3 R_body_optical = rotation_body_optical();
  const Se3 T_world_base = T_world_camera * T_base_camera.inverse();
  const Vector3 forward = R_body_optical * T_world_base.R.col(0);
  const double heading = atan2(forward.y(), forward.x());
  const Matrix3 R = rotation_exp({0, 0, -heading}) * R_body_optical;
  return {R, -(R * T_world_base.t)};
}

}  // namespace plvo
