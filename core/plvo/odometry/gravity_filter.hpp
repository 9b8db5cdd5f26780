// SPDX-License-Identifier: Apache-2.0
// Corrects roll and pitch of the pose by the direction of gravity. That direction g is fixed in the world but
// unknown at first; the offset β of the sensor is fixed in the camera, and unknown as well. Both are
// estimated together with the poses and the covariances between them. Early readings determine g, later ones
// the tilt of the pose since then, and readings in other attitudes determine β.
//
// A reading z of the direction has unit length and is in the camera's axes: z = R_world_cameraᵀ g + β +
// noise. To first order in the errors ω of the orientation (in the axes of the world), ε of g and β of the
// offset,
//   Uᵀ (z − R_cw g − β) = Uᵀ (R_cw ([g]× ω + ε) + β) + noise,   U: two unit vectors across R_cw g.
// A Kalman step corrects the pose, the pose that it is chained to, g and β. To first order this equals a term
// in the joint cost, because the estimate of the motion is Gaussian at that stage.
#pragma once

#include "plvo/math/se3.hpp"
#include "plvo/motion/motion_prior.hpp"
#include "plvo/odometry/window/pose_with_covariance.hpp"

namespace plvo {

class GravityFilter {
 public:
  // Whether a reading has determined the direction of gravity in the world.
  bool known() const { return known_; }
  // The estimate itself, for tests: the odometry only uses the poses that it corrects.
  const Vector3& down_in_world() const { return down_; }     // unit length
  const Vector3& offset() const { return offset_; }          // in the camera's axes, as a share of g
  const Matrix6& covariance() const { return covariance_; }  // of (ε, β)
  void forget() { *this = GravityFilter(); }

  // Defines the world by a reading: y points along the measured gravity, and the heading is the camera's. The
  // direction of gravity in this world is exact; the pose has the error of the reading. pose: of the camera
  // that the reading belongs to. The reading must have passed MotionPrior::validate().
  void level(const GravityPrior& reading, PoseWithCovariance& pose);

  // Takes in a reading at `current`, which is advance() of `from`; both are corrected. The first reading
  // determines the direction of gravity and corrects nothing. A reading beyond the 99.9 % quantile of the
  // expected ones (a jolt) is left out. The reading must have passed MotionPrior::validate().
  void read(const GravityPrior& reading, PoseWithCovariance& from, PoseWithCovariance& current);

 private:
  void start(const Vector3& z, const GravityPrior& reading, const Matrix<6, 3>& from_omega,
             PoseWithCovariance& from, PoseWithCovariance& current);

  bool known_ = false;
  Vector3 down_ = Vector3(0, 1, 0), offset_ = Vector3::Zero();
  Matrix6 covariance_ = Matrix6::Zero();
};

}  // namespace plvo
