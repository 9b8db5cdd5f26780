// SPDX-License-Identifier: Apache-2.0
// Holds roll and pitch of the pose by the direction in which things fall. That direction g is fixed in the
// world but nobody knows it at first; a sensor's offset β is fixed in the camera, and not known either. Both
// are estimated together with the poses, with the covariances between them: early readings say where down is,
// later ones how far the pose has tilted since, and readings in other attitudes what the offset is.
//
// A reading z of the direction, unit length, in the camera's axes: z = R_world_cameraᵀ g + β + noise. To
// first order in the errors ω of the orientation (in the axes of the world), ε of g and β of the offset,
//   Uᵀ (z − R_cw g − β) = Uᵀ (R_cw ([g]× ω + ε) + β) + noise,   U: two unit vectors across R_cw g,
// and a Kalman step corrects the pose, the pose that it was chained to, g and β. To first order this is what
// a term in the joint cost would do, for the motion's estimate is Gaussian by then.
#pragma once

#include "plvo/math/se3.hpp"
#include "plvo/motion/motion_prior.hpp"

namespace plvo {

// A pose, and how its error goes with those of gravity.
struct PoseWithCovariance {
  Se3 T_world_camera;
  Matrix6 covariance = Matrix6::Zero();               // of the ⊞-perturbation
  Matrix6 covariance_with_gravity = Matrix6::Zero();  // rows as of covariance; columns (ε, β)
};

// `from` moved on by T_current_from of this covariance (of its ⊞-perturbation).
PoseWithCovariance advance(const PoseWithCovariance& from, const Se3& T_current_from,
                           const Matrix6& motion_covariance);

// Brings its covariance within the bound and makes it one again (covariance.hpp); bit by bit the same where
// nothing was wrong. False where the pose or the covariance is not finite.
bool settle(PoseWithCovariance& pose);

class GravityFilter {
 public:
  // Whether a reading has said where down is in the world.
  bool known() const { return known_; }
  // The estimate itself, for proofs: the odometry only has poses corrected by it.
  const Vector3& down_in_world() const { return down_; }     // unit length
  const Vector3& offset() const { return offset_; }          // in the camera's axes, of a unit vector
  const Matrix6& covariance() const { return covariance_; }  // of (ε, β)
  void forget() { *this = GravityFilter(); }

  // Makes a world of a reading: y points where it says that things fall, the heading is the camera's. Where
  // down is in such a world is known for certain; what is not is the pose, by the reading's error. pose: of
  // the camera that the reading is of; it must have passed MotionPrior::validate().
  void level(const GravityPrior& reading, PoseWithCovariance& pose);

  // A reading at `current`, which is advance() of `from`; both are corrected. The first one says where down
  // is, and corrects nothing. A reading beyond the 99.9 % quantile of what is expected (a jolt) is left out.
  // The reading must have passed MotionPrior::validate().
  void read(const GravityPrior& reading, PoseWithCovariance& from, PoseWithCovariance& current);

 private:
  void start(const Vector3& z, const GravityPrior& reading, const Matrix<6, 3>& from_omega,
             PoseWithCovariance& from, PoseWithCovariance& current);

  bool known_ = false;
  Vector3 down_ = Vector3(0, 1, 0), offset_ = Vector3::Zero();
  Matrix6 covariance_ = Matrix6::Zero();
};

}  // namespace plvo
