// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/exposure.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace plvo {
namespace {

// p after `seconds` at a constant velocity, to second order in the angle: a camera that turns by 2 rad/s errs
// by 5e-6 rad within half a readout of 30 ms.
Vector3 moved(const Vector3& p, const Vector3& v, const Vector3& omega, double seconds) {
  const Vector3 theta = seconds * omega;
  const Vector3 step = theta.cross(p) + seconds * v;
  return p + step + 0.5 * theta.cross(step);
}

}  // namespace

Exposure::Exposure(const CameraModel& camera, const Vector6& velocity, double depth_after_colour_s)
    : rolling_(camera.readout_s > 0),
      row_s_(camera.readout_s / (camera.height - 1)),
      depth_row_s_(camera.depth_timing.readout_s / (camera.height - 1)),
      depth_after_colour_s_(depth_after_colour_s),
      pinhole_(camera.pinhole),
      last_row_(camera.height - 1),
      v_(velocity.head<3>()),
      omega_(velocity.tail<3>()) {
  depth_apart_ = camera.depth_timing.known && (depth_after_colour_s != 0 || depth_row_s_ != row_s_);
}

double Exposure::delay_s(const Vector3& p) const {
  const double row = std::clamp(pinhole_.fy * p.y() / p.z() + pinhole_.cy, 0.0, last_row_);
  return row_s_ * (row - 0.5 * last_row_);
}

double Exposure::depth_lag_s(double v, double depth_v) const {
  const double middle = 0.5 * last_row_;
  return depth_after_colour_s_ + depth_row_s_ * (depth_v - middle) - row_s_ * (v - middle);
}

Vector3 Exposure::at_mid_exposure(const Vector3& p) const {
  if (!rolling_ || !(p.z() > 0)) return p;
  return moved(p, v_, omega_, -delay_s(p));
}

Vector3 Exposure::as_seen(const Vector3& p_mid) const {
  if (!rolling_ || !(p_mid.z() > 0)) return p_mid;
  // The row at which it is seen depends on when it is seen; each guess is twenty times better than the one
  // before.
  Vector3 seen = p_mid;
  constexpr int kGuesses = 3;
  for (int i = 0; i < kGuesses && seen.z() > 0; ++i) seen = moved(p_mid, v_, omega_, delay_s(seen));
  return seen;
}

Vector3 Exposure::rate(const Vector3& p) const { return v_ + omega_.cross(p); }

Vector3 Exposure::at_depth_time(const Vector3& p, double v, double depth_v) const {
  return moved(p, v_, omega_, depth_lag_s(v, depth_v));
}

Vector3 Exposure::from_depth_time(const Vector3& p, double v, double depth_v) const {
  return moved(p, v_, omega_, -depth_lag_s(v, depth_v));
}

}  // namespace plvo
