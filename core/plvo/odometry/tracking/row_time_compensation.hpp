// SPDX-License-Identifier: Apache-2.0
// Removes the effect of a rolling shutter from the features of a pair of frames. This needs the camera's
// velocity during each exposure, which follows from the motion between them. So the compensation is repeated
// for every estimate of the motion (motion_model.hpp). Only the difference of the two velocities matters: a
// common one shifts the rows of both images alike.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/camera/exposure.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/features/frame_features.hpp"
#include "plvo/odometry/motion_model.hpp"

namespace plvo {

// What is known of a pair before its features are matched.
struct PairTiming {
  Se3 T_reference_last;            // of the last good frame, which may be the reference itself
  std::int64_t since_last_ns = 0;  // from the last good frame to the current one
  Velocity reference, last;        // of the reference, and of the last good frame
  bool reference_is_last = true;
  // Mean velocity since the last good frame, if it is known without the motion from the reference.
  std::optional<Vector6> recent;
  double depth_after_colour_s = 0;  // of the current frame, as in exposure.hpp
};

struct RowTimeCompensation {
  Exposure current_exposure;
  std::span<const Point3d> reference_points;
  std::span<const Line3d> reference_lines, current_lines;
  std::span<const SurfaceSample> reference_surfaces;
};

// Motion of the camera during the exposure of the current frame, given this motion from the reference.
Exposure current_exposure(const CameraModel& camera, const PairTiming& timing,
                          const Se3& T_current_reference);

// Compensates the reference's points only; otherwise as below.
RowTimeCompensation compensate_row_times_of_points(const CameraModel& camera, const PairTiming& timing,
                                                   const Se3& T_current_reference,
                                                   const FrameFeatures& reference, Arena& scratch);
// Copies the changed features into the scratch. With a global shutter there are no changes, and the features
// are used without a copy.
RowTimeCompensation compensate_row_times(const CameraModel& camera, const PairTiming& timing,
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
