// SPDX-License-Identifier: Apache-2.0
// Decides whether two keyframes of the map show the same place, and estimates the motion between them.
// Descriptors are matched over the whole image. The estimator of the tracking (motion_estimator.hpp) then
// finds a motion from the points, and a better one from points and lines.
#pragma once

#include "plvo/base/arena.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/lines/line_match.hpp"
#include "plvo/map/map_keyframe.hpp"
#include "plvo/motion/motion_estimator.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/points/point_match.hpp"

namespace plvo {

struct LoopMeasurement {
  bool found = false;
  Se3 T_old_new;
  Matrix6 covariance = Matrix6::Zero();  // of the ⊞-perturbation of T_old_new
  int inliers = 0;                       // points and lines
};

// Settings of the estimator, and the camera of the features.
struct LoopCheck {
  CameraModel camera;
  MotionConfig first_motion, motion;  // of the points alone; of points and lines
  double point_correlation = 0, line_correlation = 0;
  std::uint64_t seed = 1;

  LoopCheck() = default;
  LoopCheck(const CameraModel& of_camera, const Config& config);

  // T_predicted: T_new_old, if it is known to some centimetres; features are then searched where it puts
  // them.
  LoopMeasurement operator()(const MapFeatures& old_view, const MapFeatures& new_view, Arena& scratch,
                             const Se3* T_predicted = nullptr) const;

  // Reserves the scratch of a check.
  static constexpr void reserve(Arena& memory, const MapLimits& limits, int width, int height) {
    const ScratchScope scope(memory);
    const auto points = static_cast<std::size_t>(limits.keypoints);
    const auto segments = static_cast<std::size_t>(limits.segments);
    take_views(memory, points, segments);
    {
      const ScratchScope matching(memory);
      reserve_point_match(memory, limits.keypoints, width, height);
    }
    {
      const ScratchScope matching(memory);
      take_line_match_scratch(memory, segments, segments);
    }
    take_estimate(memory);
    size_motion(memory, 1, points, segments);
  }

 private:
  // Both views, unpacked, and their matches.
  struct Views {
    PointFeatures old_points, new_points;
    std::span<Prediction> predictions;
    std::span<Line3d> old_lines, new_lines;
    std::span<Segment> predicted, found;
    FixedVector<Match> point_matches, line_matches;
  };
  static constexpr Views take_views(Arena& memory, std::size_t points, std::size_t segments) {
    Views views;
    for (PointFeatures* side : {&views.old_points, &views.new_points}) {
      side->keypoints = FixedVector<Keypoint>(memory.take<Keypoint>("map check", points));
      side->points = memory.take<Point3d>("map check", points);
    }
    views.predictions = memory.take<Prediction>("map check", points);
    views.old_lines = memory.take<Line3d>("map check", segments);
    views.new_lines = memory.take<Line3d>("map check", segments);
    views.predicted = memory.take<Segment>("map check", segments);
    views.found = memory.take<Segment>("map check", segments);
    views.point_matches = FixedVector<Match>(memory.take<Match>("map check", points));
    views.line_matches = FixedVector<Match>(memory.take<Match>("map check", segments));
    return views;
  }
  static constexpr std::span<MotionEstimate> take_estimate(Arena& memory) {
    return memory.take<MotionEstimate>("map check", 1);
  }
  void match_points_of(const Se3* T_predicted, Views& views, Arena& scratch) const;
  void match_lines_after(const Se3& T_new_old, const MapFeatures& old_view, const MapFeatures& new_view,
                         Views& views, Arena& scratch) const;
};

}  // namespace plvo
