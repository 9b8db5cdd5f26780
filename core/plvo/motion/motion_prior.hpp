// SPDX-License-Identifier: Apache-2.0
// Prior on one frame from sensors other than the camera: the motion of the camera since the previous frame
// (gyro, wheel odometry) and the direction of gravity (accelerometer). Every part is optional.
// core/plvo/inertial computes a prior from the samples of a gyro and an accelerometer.
//
// The axes are those of the camera: x right, y down, z forward. Measurements in other axes must be rotated
// into them first. "Now" is the stamp of the frame that the prior is passed with. "Before" is the stamp of
// the last frame that the odometry accepted, whether tracking was lost there or not, because the odometry
// propagates through frames in which tracking is lost.
#pragma once

#include <optional>

#include "plvo/base/status.hpp"
#include "plvo/math/se3.hpp"

namespace plvo {

// X_now = R_now_before X_before for a camera that only rotates. The true rotation is Exp(ω) R_now_before,
// where ω has this covariance (rad², in the camera's axes now).
struct RotationPrior {
  Matrix3 R_now_before = Matrix3::Identity();
  Matrix3 covariance = Matrix3::Identity();
};

// The translation of X_now = R X_before + t_now_before, i.e. the position of the camera before in the axes of
// the camera now; m, m².
struct TranslationPrior {
  Vector3 t_now_before = Vector3::Zero();
  Matrix3 covariance = Matrix3::Identity();
};

// down: the direction of gravity in the camera's axes now, of any length > 0. covariance: of the part of the
// unit vector's error that is independent from frame to frame, rad²; only the components across the direction
// count. An accelerometer at rest measures the opposite direction. A moving one also measures its
// acceleration, which the covariance must include. offset_sigma: SD along each camera axis of the error that
// is constant over the frames, i.e. the sensor's offset divided by g. The value of the first measurement is
// used.
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
  // Returns kInvalidArgument with the name of the part for: a number that is not finite, a matrix that is not
  // a rotation (to 1e-6), a translation over 1 km, a direction of zero length, or a covariance that is not
  // symmetric and positive definite with variances between 1e-16 and 1e6.
  Status validate() const;
};

}  // namespace plvo
