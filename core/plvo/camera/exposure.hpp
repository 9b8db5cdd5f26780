// SPDX-License-Identifier: Apache-2.0
// Exposure time of each row of the colour and the depth image. A rolling shutter exposes the rows one after
// another, and depth is often exposed at another time than colour; the camera moves in between. This class
// moves a feature to the time at which the middle row of the colour image is exposed, so that a frame has a
// single pose (Ringaby & Forssén, "Scan rectification for structured light range sensors with rolling
// shutters", ICCV 2011). It also predicts where the surface of a colour pixel is at the time of depth, so
// that the depth can be read there. It assumes a known, constant velocity.
#pragma once

#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

class Exposure {
 public:
  // A global shutter with depth at the same time, or a camera at rest: no point moves.
  Exposure() = default;
  // velocity: (v, ω) per second, the motion of the scene in the camera frame, dX/dt = v + ω × X. It is the
  // boxminus of T_now_before divided by the time in between. depth_after_colour_s: time from the exposure of
  // colour's middle row to that of depth's middle row; used if camera.depth_timing is known.
  Exposure(const CameraModel& camera, const Vector6& velocity, double depth_after_colour_s);

  // Moves p, measured in the row that it projects to, to the exposure time of the middle row. Points at or
  // behind the camera are returned unchanged.
  Vector3 at_mid_exposure(const Vector3& p) const;
  // Inverse of at_mid_exposure: moves a point from the exposure time of the middle row to that of its own
  // row.
  Vector3 as_seen(const Vector3& p_mid) const;

  // True for a rolling shutter.
  bool rolling() const { return rolling_; }
  // Seconds from the exposure of the middle row to that of the row that p projects to.
  double delay_s(const Vector3& p) const;

  // True if row v of depth is not exposed together with row v of colour.
  bool depth_apart() const { return depth_apart_; }
  // Moves p from the exposure of colour's row v to that of depth's row depth_v, and back. Rows are in pixels.
  Vector3 at_depth_time(const Vector3& p, double v, double depth_v) const;
  Vector3 from_depth_time(const Vector3& p, double v, double depth_v) const;
  // Moves p from the exposure of colour's row v to that of the depth row that sees it.
  Vector3 as_depth_sees(const Vector3& p, double v) const;

  // Largest distance in pixels between the depth readings of one colour pixel with this motion and with that
  // of `other`: at the corners of the image, for surfaces 1 m away.
  double depth_shift_px(const Exposure& other) const;

  // Seconds from the exposure of colour's middle row to that of depth's row depth_v. Valid if depth_apart().
  double depth_delay_s(double depth_v) const { return depth_lag_s(0.5 * last_row_, depth_v); }
  // Velocity of a point at p, m/s.
  Vector3 rate(const Vector3& p) const;

  const Pinhole& pinhole() const { return pinhole_; }

 private:
  // Seconds from the exposure of colour's row v to that of depth's row depth_v.
  double depth_lag_s(double v, double depth_v) const;

  bool rolling_ = false, depth_apart_ = false;
  double row_s_ = 0, depth_row_s_ = 0;  // time from one row to the next
  double depth_after_colour_s_ = 0;
  Pinhole pinhole_;
  double last_row_ = 0;
  Vector3 v_ = Vector3::Zero(), omega_ = Vector3::Zero();
};

}  // namespace plvo
