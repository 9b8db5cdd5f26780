// SPDX-License-Identifier: Apache-2.0
#include "plvo/report/frame_recorder.hpp"

#include <cmath>

#include "plvo/replay/images/image_writer.hpp"
#include "plvo/report/drawing.hpp"

namespace plvo::report {
namespace {

constexpr int kImageQuality = 60;
constexpr int kDepthQuality = 70;

int tenths(float px) { return static_cast<int>(std::lround(10 * px)); }

std::vector<int> keypoint_rows(const FeatureView& f) {
  std::vector<int> rows;
  for (const Keypoint& k : f.keypoints) rows.insert(rows.end(), {tenths(k.u), tenths(k.v), k.level});
  return rows;
}

std::vector<int> track_rows(const FeatureView& f) {
  std::vector<int> rows;
  for (const PointTrackView& t : f.point_tracks) {
    rows.insert(rows.end(),
                {tenths(t.u), tenths(t.v), tenths(t.u_reference), tenths(t.v_reference), t.inlier ? 1 : 0});
  }
  return rows;
}

std::vector<int> segment_rows(const FeatureView& f) {
  std::vector<int> rows;
  const std::vector<SegmentFate> fates = segment_fates(f);
  for (std::size_t i = 0; i < fates.size(); ++i) {
    const SegmentView& s = f.segments[i];
    const bool matched = fates[i].reference >= 0;
    const SegmentView& r = matched ? f.reference_segments[static_cast<std::size_t>(fates[i].reference)] : s;
    rows.insert(rows.end(),
                {tenths(s.a_u), tenths(s.a_v), tenths(s.b_u), tenths(s.b_v), static_cast<int>(fates[i].kind),
                 tenths(r.a_u), tenths(r.a_v), tenths(r.b_u), tenths(r.b_v)});
  }
  return rows;
}

}  // namespace

RecordedFrame record_frame(std::size_t number, const RgbdFrame& frame, const TrackResult& result,
                           const FeatureView& f) {
  RecordedFrame kept;
  kept.number = number;
  kept.stamp_ns = frame.stamp_ns;
  kept.state = to_string(result.state);
  kept.reason = result.status.message();
  kept.points = result.points;
  kept.lines = result.lines;
  kept.width = f.image.width;
  kept.height = f.image.height;
  kept.image_jpeg = encode_jpeg(
      {f.image.data, f.image.width, f.image.height, f.image.stride, PixelFormat::kGray8}, kImageQuality);
  kept.depth_jpeg = encode_jpeg(draw_depth(frame.depth).view(), kDepthQuality);
  kept.keypoints = keypoint_rows(f);
  kept.tracks = track_rows(f);
  kept.segments = segment_rows(f);
  return kept;
}

void FrameRecorder::offer(std::size_t number, const RgbdFrame& frame, const TrackResult& result,
                          const Odometry& odometry) {
  if (wanted_ == 0 || number % step_ != 0) return;
  frames_.push_back(record_frame(number, frame, result, odometry.features()));
  if (frames_.size() < 2 * wanted_) return;
  step_ *= 2;
  std::erase_if(frames_, [this](const RecordedFrame& f) { return f.number % step_ != 0; });
}

}  // namespace plvo::report
