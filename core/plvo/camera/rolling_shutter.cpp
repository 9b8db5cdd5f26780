// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/rolling_shutter.hpp"

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

RollingShutter::RollingShutter(const CameraModel& camera, const Vector6& velocity)
    : active_(camera.readout_s > 0),
      row_s_(camera.readout_s / (camera.height - 1)),
      fy_(camera.pinhole.fy),
      cy_(camera.pinhole.cy),
      last_row_(camera.height - 1),
      v_(velocity.head<3>()),
      omega_(velocity.tail<3>()) {}

double RollingShutter::delay_s(const Vector3& p) const {
  const double row = std::clamp(fy_ * p.y() / p.z() + cy_, 0.0, last_row_);
  return row_s_ * (row - 0.5 * last_row_);
}

Vector3 RollingShutter::at_mid_exposure(const Vector3& p) const {
  if (!active_ || !(p.z() > 0)) return p;
  return moved(p, v_, omega_, -delay_s(p));
}

Vector3 RollingShutter::as_seen(const Vector3& p_mid) const {
  if (!active_ || !(p_mid.z() > 0)) return p_mid;
  // The row at which it is seen depends on when it is seen; each guess is twenty times better than the one
  // before.
  Vector3 seen = p_mid;
  constexpr int kGuesses = 3;
  for (int i = 0; i < kGuesses && seen.z() > 0; ++i) seen = moved(p_mid, v_, omega_, delay_s(seen));
  return seen;
}

}  // namespace plvo
