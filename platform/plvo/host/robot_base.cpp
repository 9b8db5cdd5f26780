// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/robot_base.hpp"

namespace plvo {
namespace {

// A T A⁻¹, and the covariance of its ⊞-perturbation.
void conjugate(const Se3& A, Se3& T, Matrix6& covariance) {
  const Matrix6 exact = Matrix6::Zero();
  const Se3 A_inverse = A.inverse();
  const Se3 A_T = A * T;
  covariance = compose_covariance(A, exact, T, covariance);
  covariance = compose_covariance(A_T, covariance, A_inverse, exact);
  T = A_T * A_inverse;
}

}  // namespace

TrackResult result_of_base(const TrackResult& result, const Se3& T_base_camera) {
  TrackResult base = result;
  conjugate(T_base_camera, base.T_world_camera, base.pose_covariance);
  conjugate(T_base_camera, base.T_camera_reference, base.motion_covariance);
  return base;
}

}  // namespace plvo
