// SPDX-License-Identifier: Apache-2.0
// Keeps a bounded number of frames for the report, evenly spaced over a run of unknown length: it keeps every
// n-th frame. When it holds twice the desired number, it drops every second one and doubles n.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plvo/image/frame.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo::report {

struct RecordedFrame {
  std::size_t number = 0;
  std::int64_t stamp_ns = 0;
  std::string state, reason;
  FeatureCounts points, lines;
  int width = 0, height = 0;
  std::vector<std::uint8_t> image_jpeg, depth_jpeg;
  // Rows as the page reads them, in tenths of a pixel: keypoints u v level; tracks u v reference_u
  // reference_v inlier; segments a_u a_v b_u b_v kind and the same four of the reference.
  std::vector<int> keypoints, tracks, segments;
};

class FrameRecorder {
 public:
  explicit FrameRecorder(std::size_t wanted) : wanted_(wanted) {}

  // Call for each frame directly after track(); copies what it keeps.
  void offer(std::size_t number, const RgbdFrame& frame, const TrackResult& result, const Odometry& odometry);
  const std::vector<RecordedFrame>& frames() const { return frames_; }

 private:
  std::size_t wanted_;
  std::size_t step_ = 1;
  std::vector<RecordedFrame> frames_;
};

// Returns the image and features of one frame.
RecordedFrame record_frame(std::size_t number, const RgbdFrame& frame, const TrackResult& result,
                           const FeatureView& features);

}  // namespace plvo::report
