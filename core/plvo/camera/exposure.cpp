// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/exposure.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace plvo {
namespace {

// Path of a point at constant velocity, to second order in the angle. At 2 rad/s, the error within half a
// readout of 30 ms is 5e-6 rad.
struct Path {
  Vector3 p, rate, bend;
  Path(const Vector3& at, const Vector3& v, const Vector3& omega)
      : p(at), rate(omega.cross(at) + v), bend(0.5 * omega.cross(rate)) {}
  Vector3 after(double seconds) const { return p + seconds * (rate + seconds * bend); }
};

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
  return Path(p, v_, omega_).after(-delay_s(p));
}

Vector3 Exposure::as_seen(const Vector3& p_mid) const {
  if (!rolling_ || !(p_mid.z() > 0)) return p_mid;
  // The row in which the point is seen depends on the time, and the time on the row. Each iteration reduces
  // the error by a factor of twenty.
  const Path path(p_mid, v_, omega_);
  Vector3 seen = p_mid;
  constexpr int kGuesses = 3;
  for (int i = 0; i < kGuesses && seen.z() > 0; ++i) seen = path.after(delay_s(seen));
  return seen;
}

Vector3 Exposure::rate(const Vector3& p) const { return v_ + omega_.cross(p); }

Vector3 Exposure::at_depth_time(const Vector3& p, double v, double depth_v) const {
  return Path(p, v_, omega_).after(depth_lag_s(v, depth_v));
}

double Exposure::depth_shift_px(const Exposure& other) const {
  double largest = 0;
  for (const double u : {0.0, 2 * pinhole_.cx})
    for (const double v : {0.0, last_row_}) {
      const Vector3 p((u - pinhole_.cx) / pinhole_.fx, (v - pinhole_.cy) / pinhole_.fy, 1);
      const Vector3 here = as_depth_sees(p, v);
      const Vector3 there = other.as_depth_sees(p, v);
      if (!(here.z() > 0 && there.z() > 0)) return pinhole_.fx;
      const double shift = sqrt((project(pinhole_, here) - project(pinhole_, there)).squaredNorm());
      if (shift > largest) largest = shift;
    }
  return largest;
}

Vector3 Exposure::as_depth_sees(const Vector3& p, double v) const {
  // Same iteration as in as_seen. For depth, a tenth of a pixel is accurate enough.
  const Path path(p, v_, omega_);
  Vector3 seen = p;
  double depth_v = v;
  constexpr int kGuesses = 2;
  for (int i = 0; i < kGuesses && seen.z() > 0; ++i) {
    seen = path.after(depth_lag_s(v, depth_v));
    depth_v = pinhole_.fy * seen.y() / seen.z() + pinhole_.cy;
  }
  return seen;
}

Vector3 Exposure::from_depth_time(const Vector3& p, double v, double depth_v) const {
  return Path(p, v_, omega_).after(-depth_lag_s(v, depth_v));
}

}  // namespace plvo
