// SPDX-License-Identifier: Apache-2.0
// All that is kept of a frame: its features in 2D and 3D. They serve as the reference for the next frame, or
// for many frames if the frame is a keyframe.
#pragma once

#include <cstdint>

#include "plvo/base/arena.hpp"
#include "plvo/lines/line_features.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/features/feature_budget.hpp"
#include "plvo/odometry/features/feature_counts.hpp"
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

  // The number of points and lines with 3D.
  int count_3d() const { return static_cast<int>(points.keypoints.size() + lines.count_3d); }

  constexpr void allocate(Arena& memory, const Limits& limits) {
    points.allocate(memory, limits.keypoints);
    lines.allocate(memory, limits.segments);
    surfaces.allocate(memory, limits.surfaces);
  }
};

// Counts of a frame's features, without matches. Every keypoint has depth: the detector skips the others.
inline FeatureCounts count(const PointFeatures& points) {
  return {.detected = points.candidates,
          .dropped = static_cast<int>(points.keypoints.dropped()),
          .with_depth = static_cast<int>(points.keypoints.size())};
}
inline FeatureCounts count(const LineFeatures& lines) {
  return {.detected = static_cast<int>(lines.segments.size() + lines.segments.dropped()),
          .dropped = static_cast<int>(lines.segments.dropped()),
          .with_depth = static_cast<int>(lines.count_3d)};
}

}  // namespace plvo
