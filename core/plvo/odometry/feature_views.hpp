// SPDX-License-Identifier: Apache-2.0
// The features of the last frame, for drawing.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/odometry/tracking/reference_tracking.hpp"

namespace plvo {

// A track pairs a position in the reference with the position in this frame where it was found.
struct PointTrackView {
  float u_reference = 0, v_reference = 0, u = 0, v = 0;  // px
  bool inlier = false;
};
struct LineTrackView {
  std::uint16_t reference = 0, current = 0;  // indices into reference_segments and segments
  bool inlier = false;
};
struct SegmentView {
  float a_u = 0, a_v = 0, b_u = 0, b_v = 0;  // px
  bool has_3d = false;
};
// Pixels are those of the undistorted image. Valid until the next call of track().
struct FeatureView {
  GrayView image;                       // undistorted, grey
  std::span<const Keypoint> keypoints;  // empty if none were searched (Window::kRecentFrames)
  std::span<const SegmentView> segments, reference_segments;
  std::span<const PointTrackView> point_tracks;
  std::span<const LineTrackView> line_tracks;
};

// Keeps the tracks and segments, which the next stages of a frame overwrite.
class FeatureViews {
 public:
  constexpr void allocate(Arena& memory, const Limits& limits) {
    const auto segments = static_cast<std::size_t>(limits.segments);
    point_tracks_ =
        FixedVector(memory.take<PointTrackView>("feature view", static_cast<std::size_t>(limits.keypoints)));
    line_tracks_ = FixedVector(memory.take<LineTrackView>("feature view", segments));
    segments_ = FixedVector(memory.take<SegmentView>("feature view", segments));
    reference_segments_ = FixedVector(memory.take<SegmentView>("feature view", segments));
  }
  void clear();
  void show(const LineFeatures& current);
  // The tracks of one reference.
  void show_tracks(const FrameFeatures& reference, const ReferenceTracks& tracks);

  // All but the image and the keypoints, which the odometry keeps.
  FeatureView view() const;

 private:
  FixedVector<PointTrackView> point_tracks_;
  FixedVector<LineTrackView> line_tracks_;
  FixedVector<SegmentView> segments_, reference_segments_;
};

}  // namespace plvo
