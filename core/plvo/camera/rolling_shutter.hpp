// SPDX-License-Identifier: Apache-2.0
// A rolling shutter exposes one row after the other, and the camera moves meanwhile: two features of one
// frame are not seen from one place. With the velocity of the camera known, each can be carried to where it
// would have been seen while the middle row was exposed, and a frame has one pose again (Ringaby & Forssén,
// "Scan rectification for structured light range sensors with rolling shutters", ICCV 2011).
#pragma once

#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

class RollingShutter {
 public:
  // A global shutter, or a camera at rest: nothing moves.
  RollingShutter() = default;
  // velocity: (v, ω) per second, how the scene moves in the camera's frame, dX/dt = v + ω × X; that of
  // T_now_before, taken by boxminus, over the time between.
  RollingShutter(const CameraModel& camera, const Vector6& velocity);

  bool active() const { return active_; }
  // p as measured, at the row that it projects to → as the middle row's moment would have it. Points at or
  // behind the camera are returned as they are.
  Vector3 at_mid_exposure(const Vector3& p) const;
  // The other way round: where a point of the middle row's moment is when its own row is exposed.
  Vector3 as_seen(const Vector3& p_mid) const;

 private:
  // Seconds from the middle row's exposure to that of the row which p projects to.
  double delay_s(const Vector3& p) const;

  bool active_ = false;
  double row_s_ = 0;  // from one row to the next
  double fy_ = 0, cy_ = 0, last_row_ = 0;
  Vector3 v_ = Vector3::Zero(), omega_ = Vector3::Zero();
};

}  // namespace plvo
