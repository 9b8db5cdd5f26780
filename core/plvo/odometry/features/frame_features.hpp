// SPDX-License-Identifier: Apache-2.0
// All that is kept of a frame: its features in 2D and 3D. They serve as the reference for the next frame, or
// for many frames if the frame is a keyframe.
#pragma once

#include <cstdint>

#include "plvo/base/arena.hpp"
#include "plvo/lines/line_features.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/features/feature_budget.hpp"
#include "plvo/points/keypoint.hpp"
#include "plvo/surfaces/surface_features.hpp"

namespace plvo {

struct FrameFeatures {
  std::int64_t stamp_ns = 0;
  PointFeatures points;
  LineFeatures lines;
  SurfaceFeatures surfaces;

  // Removes all features and sets the capacity, within what was allocated.
  void clear(const FeatureCapacity& capacity) {
    points.clear(capacity.keypoints);
    lines.clear(capacity.segments);
    surfaces.samples.clear();
  }

  constexpr void allocate(Arena& memory, const Limits& limits) {
    points.allocate(memory, limits.keypoints);
    lines.allocate(memory, limits.segments);
    surfaces.allocate(memory, limits.surfaces);
  }
};

}  // namespace plvo
