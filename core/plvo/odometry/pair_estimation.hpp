// SPDX-License-Identifier: Apache-2.0
// Figure 1, boxes P4, L4, 5 and 6: the motion between a reference's features and the current frame's.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/motion/motion_estimator.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/feature_extraction.hpp"
#include "plvo/odometry/frame_features.hpp"
#include "plvo/odometry/line_tracking.hpp"
#include "plvo/odometry/mid_exposure.hpp"
#include "plvo/odometry/point_tracking.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo {

class PairEstimation {
 public:
  template <typename Memory>
  constexpr void carve(Memory& memory, const Limits& limits) {
    point_tracks_.carve(memory, limits.keypoints);
    point_inliers_ =
        memory.template take<std::uint8_t>("point tracks", static_cast<std::size_t>(limits.keypoints));
    const auto segments = static_cast<std::size_t>(limits.segments);
    line_matches_ = FixedVector<Match>(memory.template take<Match>("line tracks", segments));
    line_inliers_ = memory.template take<std::uint8_t>("line tracks", segments);
  }
  // Scratch: the larger of the stages, which come one after the other.
  template <typename Memory>
  static constexpr void reserve(Memory& memory, const Limits& limits) {
    const ScratchScope scope(memory);
    take_mid_exposure(memory, limits);
    reserve_tracking(memory, limits.keypoints, limits.width, limits.height);
    reserve_line_tracking(memory, limits.segments);
    size_motion(memory, static_cast<std::size_t>(limits.keypoints),
                static_cast<std::size_t>(limits.segments));
  }

  void init(const CameraModel& camera, const Config& config);

  // radius_px: how far from where the prior has them features are looked for. Counts and times go to
  // `result`, the tracks stay for a look at them.
  MotionEstimate estimate(const FrameFeatures& reference, const FrameFeatures& current,
                          const Pyramid& pyramid, const DepthSampler& depth, const PairPrior& prior,
                          double radius_px, Arena& scratch, TrackResult& result);

  std::span<const Match> line_matches() const { return line_matches_.span(); }
  std::span<const std::uint8_t> line_inliers() const { return line_inliers_.first(line_matches_.size()); }
  const PointTracks& point_tracks() const { return point_tracks_; }
  std::span<const std::uint8_t> point_inliers() const {
    return point_inliers_.first(point_tracks_.matches.size());
  }

 private:
  MotionEstimate solve(const MidExposure& features, const Se3& T_predicted, const LmOptions& lm,
                       Arena& scratch, TrackResult& result);

  CameraModel camera_;
  Config config_;
  PointTracks point_tracks_;
  std::span<std::uint8_t> point_inliers_;
  FixedVector<Match> line_matches_;
  std::span<std::uint8_t> line_inliers_;
};

}  // namespace plvo
