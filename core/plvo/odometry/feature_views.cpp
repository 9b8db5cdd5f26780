// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/feature_views.hpp"

namespace plvo {
namespace {

void fill_segments(const LineFeatures& lines, FixedVector<SegmentView>& views) {
  views.clear();
  for (std::size_t i = 0; i < lines.segments.size(); ++i) {
    const Segment& segment = lines.segments[i];
    views.push_back({static_cast<float>(segment.a.x()), static_cast<float>(segment.a.y()),
                     static_cast<float>(segment.b.x()), static_cast<float>(segment.b.y()),
                     i < lines.count_3d});
  }
}

}  // namespace

void FeatureViews::clear() {
  point_tracks_.clear();
  line_tracks_.clear();
  segments_.clear();
  reference_segments_.clear();
}

void FeatureViews::show(const LineFeatures& current) { fill_segments(current, segments_); }

void FeatureViews::show_tracks(const FrameFeatures& reference, const ReferenceTracks& tracks) {
  for (std::size_t i = 0; i < tracks.points.matches.size(); ++i) {
    const Keypoint& from = reference.points.keypoints[tracks.points.matches[i].reference];
    const Vector2& to = tracks.points.pixels[i];
    point_tracks_.push_back({from.u, from.v, static_cast<float>(to.x()), static_cast<float>(to.y()),
                             tracks.point_inliers[i] != 0});
  }
  fill_segments(reference.lines, reference_segments_);
  for (std::size_t i = 0; i < tracks.lines.size(); ++i)
    line_tracks_.push_back({tracks.lines[i].reference, tracks.lines[i].current, tracks.line_inliers[i] != 0});
}

FeatureView FeatureViews::view() const {
  FeatureView view;
  view.segments = segments_.span();
  view.reference_segments = reference_segments_.span();
  view.point_tracks = point_tracks_.span();
  view.line_tracks = line_tracks_.span();
  return view;
}

}  // namespace plvo
