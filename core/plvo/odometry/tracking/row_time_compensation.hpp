// SPDX-License-Identifier: Apache-2.0
// Takes a rolling shutter out of the features of a pair. Each frame needs the camera's velocity while it was
// exposed, and the velocity is what the pair is about to tell: so this is done for every guess of the motion
// anew. The reference moves as the mean of before and after. The current frame moves as it did since the last
// good frame, plus half of what extrapolating the change of velocity would add: all of it would add its noise
// too. What matters is the difference of the two: a common velocity shifts the rows of both images alike.
#pragma once

#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/camera/exposure.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/features/frame_features.hpp"

namespace plvo {

// What is known of a pair before its features are looked at.
struct PairPrior {
  Se3 T_current_reference;                       // as expected
  Se3 T_reference_last;                          // of the last good frame, which may be the reference itself
  double seconds_since_last = 0;                 // from the last good frame to the current one
  Vector6 reference_velocity = Vector6::Zero();  // per second, as of exposure.hpp
  bool reference_velocity_known = false;
  bool reference_is_last = true;
  Vector6 last_velocity = Vector6::Zero();  // of the last good frame
  bool last_velocity_known = false;
  double depth_after_colour_s = 0;  // of the current frame, as of exposure.hpp
  // Of the current frame, where it is known without the motion from the reference.
  Vector6 velocity = Vector6::Zero();
  bool velocity_known = false;
};

struct RowTimeCompensation {
  Exposure current_exposure;
  std::span<const Point3d> reference_points;
  std::span<const Line3d> reference_lines, current_lines;
  std::span<const SurfaceSample> reference_surfaces;
};

// How the camera moved while the current frame was exposed, if this is the motion.
Exposure current_exposure(const CameraModel& camera, const PairPrior& prior, const Se3& T_current_reference);

// Of the reference's points alone; otherwise as below.
RowTimeCompensation compensate_row_times_of_points(const CameraModel& camera, const PairPrior& prior,
                                                   const Se3& T_current_reference,
                                                   const FrameFeatures& reference, Arena& scratch);
// Copies into the scratch what changes; with a global shutter nothing does, and the features are used as they
// are.
RowTimeCompensation compensate_row_times(const CameraModel& camera, const PairPrior& prior,
                                         const Se3& T_current_reference, const FrameFeatures& reference,
                                         const FrameFeatures& current, Arena& scratch);

constexpr void take_row_times_of_points(Arena& memory, const Limits& limits) {
  memory.take<Point3d>("at mid-exposure", static_cast<std::size_t>(limits.keypoints));
}
constexpr void take_row_times(Arena& memory, const Limits& limits) {
  take_row_times_of_points(memory, limits);
  memory.take<Line3d>("at mid-exposure", static_cast<std::size_t>(limits.segments));
  memory.take<Line3d>("at mid-exposure", static_cast<std::size_t>(limits.segments));
  if (limits.surfaces > 0)
    memory.take<SurfaceSample>("at mid-exposure", static_cast<std::size_t>(limits.surfaces));
}

}  // namespace plvo
