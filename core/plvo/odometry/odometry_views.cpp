// SPDX-License-Identifier: Apache-2.0
// The views of the last frame that features() returns.
#include "plvo/odometry/odometry.hpp"

namespace plvo {

std::size_t Odometry::fill_segment_views(const LineFeatures& lines, std::span<SegmentView> views) {
  for (std::size_t i = 0; i < lines.segments.size(); ++i) {
    const Segment& segment = lines.segments[i];
    views[i] = {static_cast<float>(segment.a.x()), static_cast<float>(segment.a.y()),
                static_cast<float>(segment.b.x()), static_cast<float>(segment.b.y()), i < lines.count_3d};
  }
  return lines.segments.size();
}

// Fills the tracks of the latest reference; without a motion there are none.
void Odometry::fill_track_views(const MotionEstimate& motion) {
  if (motion.status != StatusCode::kOk) return;
  const bool both = window_.has_recent();
  const FrameFeatures& reference = window_[both ? window_.recent() : window_.keyframe()].features;
  const ReferenceTracks& tracks = memory_.tracking.tracks(both ? 1 : 0);
  point_track_count_ = tracks.points.matches.size();
  for (std::size_t i = 0; i < point_track_count_; ++i) {
    const Keypoint& from = reference.points.keypoints[tracks.points.matches[i].reference];
    const Vector2& to = tracks.points.pixels[i];
    memory_.point_track_views[i] = {from.u, from.v, static_cast<float>(to.x()), static_cast<float>(to.y()),
                                    tracks.point_inliers[i] != 0};
  }
  reference_segment_count_ = fill_segment_views(reference.lines, memory_.reference_segment_views);
  line_track_count_ = tracks.lines.size();
  for (std::size_t i = 0; i < line_track_count_; ++i)
    memory_.line_track_views[i] = {tracks.lines[i].reference, tracks.lines[i].current,
                                   tracks.line_inliers[i] != 0};
}

FeatureView Odometry::features() const {
  FeatureView view;
  if (!ready_ || !has_stamp_) return view;
  view.image = memory_.extraction.pyramid().level(0);
  view.keypoints = window_[view_slot_].features.points.keypoints.span();
  view.point_tracks = memory_.point_track_views.first(point_track_count_);
  view.segments = memory_.segment_views.first(segment_count_);
  view.reference_segments = memory_.reference_segment_views.first(reference_segment_count_);
  view.line_tracks = memory_.line_track_views.first(line_track_count_);
  return view;
}

}  // namespace plvo
