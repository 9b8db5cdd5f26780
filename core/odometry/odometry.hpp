// SPDX-License-Identifier: Apache-2.0
// The front door: frames in, poses with covariances out. After Lu & Song, "Robust RGB-D Odometry Using Point
// and Line Features" (ICCV 2015), Figure 1.
//
//   alignas(plvo::kArenaAlignment) static std::byte memory[plvo::required_bytes(plvo::Limits::vga())];
//   plvo::Odometry odometry;
//   plvo::Status status = odometry.init(memory, camera, plvo::Config{}, plvo::Limits::vga());
//   plvo::TrackResult result = odometry.track(frame);
//
// Memory: init carves the caller's block once; nothing is taken or returned afterwards. Threads: an Odometry
// is used by one thread at a time. Determinism: the same frames and config give the same bits on every
// supported machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/match.hpp"
#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo {

// A look at what the last frame was made of, for drawing: pixels of the undistorted image. Valid until the
// next call of track(). `matches` index `keypoints` (current) and `reference_keypoints`; the flag of the same
// index says inlier.
struct KeypointView {
  float u = 0, v = 0;  // px
  float size_px = 0;   // diameter of what was described
  bool has_depth = false;
};
struct SegmentView {
  float a_u = 0, a_v = 0, b_u = 0, b_v = 0;  // px
  bool has_depth = false;
};
struct FeatureView {
  GrayView image;  // undistorted, grey
  std::span<const KeypointView> keypoints, reference_keypoints;
  std::span<const SegmentView> segments, reference_segments;
  std::span<const Match> point_matches, line_matches;
  std::span<const std::uint8_t> point_inliers, line_inliers;
};

class Odometry {
 public:
  // Checks everything once, carves `memory`, builds the tables. kOutOfMemory says how many bytes are needed.
  Status init(std::span<std::byte> memory, const CameraModel& camera, const Config& config = {},
              const Limits& limits = Limits::vga());

  // Never fails: what went wrong is in the result's state and status. A frame of the wrong size, with null
  // views, or not later than the one before is refused (kLost, kInvalidArgument) and changes nothing.
  TrackResult track(const RgbdFrame& frame);

  // Who took what of the block, and the high-water mark of the scratch behind it.
  std::span<const Arena::Record> memory_records() const;
  std::size_t memory_used() const;
  std::size_t memory_peak() const;

  FeatureView features() const;

 private:
  struct Impl;
  Arena arena_;
  Impl* impl_ = nullptr;  // lives in the arena
};

// Bytes that init needs for these capacities.
constexpr std::size_t required_bytes(const Limits& limits);

}  // namespace plvo
