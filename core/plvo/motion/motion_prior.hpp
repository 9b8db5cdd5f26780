// SPDX-License-Identifier: Apache-2.0
// What sensors other than the camera say of one frame: how the camera moved since the frame before (a gyro,
// wheel odometry), and where down is (an accelerometer). Every part may be missing. core/plvo/inertial makes
// one from the samples of a gyro and an accelerometer.
//
// Axes are those of the camera: x right, y down, z forward; a sensor of other axes is turned into them first.
// "Now" is the stamp of the frame that the prior is given with, "before" that of the frame before it which
// the odometry did not refuse, lost or not: what it cannot see it goes on from.
#pragma once

#include <optional>

#include "plvo/base/status.hpp"
#include "plvo/math/se3.hpp"

namespace plvo {

// X_now = R_now_before X_before for a camera that only turns; the true rotation is Exp(ω) R_now_before, ω of
// this covariance: rad², in the camera's axes now.
struct RotationPrior {
  Matrix3 R_now_before = Matrix3::Identity();
  Matrix3 covariance = Matrix3::Identity();
};

// The translation of X_now = R X_before + t_now_before: where the camera before stands, seen from now. m, m².
struct TranslationPrior {
  Vector3 t_now_before = Vector3::Zero();
  Matrix3 covariance = Matrix3::Identity();
};

// The direction in which things fall, in the camera's axes now, of any length > 0. covariance: of the unit
// vector, rad², of what is new in each frame; only its part across the direction counts. What an
// accelerometer at rest reads is the opposite; one that is shaken reads the acceleration as well, which
// belongs into the covariance. offset_sigma: SD, along each of the camera's axes, of an error that stays the
// same from frame to frame, the sensor's offset over g; that of the first reading holds.
struct GravityPrior {
  Vector3 down = Vector3(0, 1, 0);
  Matrix3 covariance = Matrix3::Identity();
  double offset_sigma = 0;
};

struct MotionPrior {
  std::optional<RotationPrior> rotation;
  std::optional<TranslationPrior> translation;
  std::optional<GravityPrior> gravity;

  bool tells_motion() const { return rotation.has_value() || translation.has_value(); }
  // kInvalidArgument, naming the part: a number that is not finite, a rotation that is none (to 1e-6), a
  // translation over 1 km, a direction of no length, a covariance that is not symmetric and positive definite
  // with variances between 1e-16 and 1e6.
  Status validate() const;
};

}  // namespace plvo
