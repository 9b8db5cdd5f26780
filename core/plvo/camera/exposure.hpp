// SPDX-License-Identifier: Apache-2.0
// When each row of the colour and of the depth image is exposed. A rolling shutter exposes one row after the
// other, and depth is often exposed at another moment than colour; the camera moves meanwhile. With its
// velocity known, a feature can be carried to where it would have been seen while the middle row of the
// colour image was exposed, and a frame has one pose again (Ringaby & Forssén, "Scan rectification for
// structured light range sensors with rolling shutters", ICCV 2011); and the depth of a colour pixel can be
// read where that pixel's surface was at depth's time.
#pragma once

#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

class Exposure {
 public:
  // A global shutter with depth at the same moment, or a camera at rest: nothing moves.
  Exposure() = default;
  // velocity: (v, ω) per second, how the scene moves in the camera's frame, dX/dt = v + ω × X; that of
  // T_now_before, taken by boxminus, over the time between. depth_after_colour_s: from the exposure of
  // colour's middle row to that of depth's, if camera.depth_timing is known.
  Exposure(const CameraModel& camera, const Vector6& velocity, double depth_after_colour_s);

  // p as measured, at the row that it projects to → as the middle row's moment would have it. Points at or
  // behind the camera are returned as they are.
  Vector3 at_mid_exposure(const Vector3& p) const;
  // The other way round: where a point of the middle row's moment is when its own row is exposed.
  Vector3 as_seen(const Vector3& p_mid) const;

  // True when a rolling shutter's rows are exposed one after the other.
  bool rolling() const { return rolling_; }
  // Seconds from the middle row's exposure to that of the row which p projects to.
  double delay_s(const Vector3& p) const;

  // True when depth's row v is not exposed together with colour's row v.
  bool depth_apart() const { return depth_apart_; }
  // p as colour's row v saw it → where it was when depth's row depth_v was exposed, and back. Rows in px.
  Vector3 at_depth_time(const Vector3& p, double v, double depth_v) const;
  Vector3 from_depth_time(const Vector3& p, double v, double depth_v) const;
  // p as colour's row v saw it → where it was when that row of depth was exposed which shows it.
  Vector3 as_depth_sees(const Vector3& p, double v) const;

  // Seconds from the exposure of colour's middle row to that of depth's row depth_v, if depth is apart.
  double depth_delay_s(double depth_v) const { return depth_lag_s(0.5 * last_row_, depth_v); }
  // How fast a point at p moves, m/s.
  Vector3 rate(const Vector3& p) const;

  const Pinhole& pinhole() const { return pinhole_; }

 private:
  // Seconds from colour's row v to depth's row depth_v.
  double depth_lag_s(double v, double depth_v) const;

  bool rolling_ = false, depth_apart_ = false;
  double row_s_ = 0, depth_row_s_ = 0;  // from one row to the next
  double depth_after_colour_s_ = 0;
  Pinhole pinhole_;
  double last_row_ = 0;
  Vector3 v_ = Vector3::Zero(), omega_ = Vector3::Zero();
};

}  // namespace plvo
