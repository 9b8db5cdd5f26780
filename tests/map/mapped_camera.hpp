// SPDX-License-Identifier: Apache-2.0
// An odometry with a map beside it, in the procedural room. Each frame shows the view that a test asks for.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "allocation_guard.hpp"
#include "plvo/map/map.hpp"
#include "plvo/math/symmetric_eigen.hpp"
#include "procedural_sequence.hpp"

namespace plvo::test {

inline constexpr int kWidth = 160, kHeight = 120;
inline constexpr int kDark = -1;      // a view that shows nothing
inline constexpr int kTurn = 70;      // views to the turning point
inline constexpr int kFar = 100;      // so near to a wall that the odometry loses its way for a moment
inline constexpr int kMirror = 1000;  // and above: views of the mirrored room, which is another one

class MappedCamera {
 public:
  explicit MappedCamera(int keyframes, ReferencePolicy policy = Config().references.policy) {
    config_.references.policy = policy;
    config_.references.max_lost_s = 0.06;
    memory_.resize(required_bytes(limits_));
    EXPECT_TRUE(odometry.init(memory_, sequence_.camera(), config_, limits_).ok());
    MapLimits limits;
    limits.keyframes = keyframes;
    map_memory_.resize(Map::required_bytes(limits, kWidth, kHeight));
    const Status status = map.init(map_memory_, sequence_.camera(), config_, limits);
    EXPECT_TRUE(status.ok()) << status.message();
  }

  void see(int view, const MotionPrior& prior = {}) {
    RgbdFrame frame = frame_of(view);
    frame.stamp_ns = frame.depth_stamp_ns = ProceduralSequence::stamp_ns(taken_++);
    AllocationGuard guard;
    result = odometry.track(frame, prior);
    in_map = map.update(odometry, result);
    allocations += guard.calls();
    guard.disarm();
    EXPECT_TRUE(in_map.T_map_world.is_finite() && in_map.pose_covariance.allFinite());
    EXPECT_GE(symmetric_eigen<6>(in_map.pose_covariance).values.minCoeff(), -1e-9);
    if (in_map.recognised) ++recognised;
    if (in_map.removed != 0) removed_[in_map.removed] = {in_map.removed_into, in_map.T_into_removed};
    if (view != kDark && in_map.keyframe != 0 && result.state == TrackState::kTracking)
      frames_.push_back({view, in_map.keyframe, in_map.T_keyframe_camera, result.T_world_camera});
  }
  void wait(int frames) { taken_ += frames; }
  void move(int from, int to) {
    for (int view = from; view != to; view += from < to ? 1 : -1) see(view);
  }
  // Frames in which the map's work comes to an end.
  void settle(int view) {
    for (int i = 0; i < 200; ++i) see(view + (i + 1) % 2);
  }

  // Distance of the camera in the map to the truth; view 0 is the origin.
  double error_m(int view) const {
    return ((in_map.T_map_world * result.T_world_camera).t - truth(view).t).norm();
  }
  // Root mean square over all frames.
  double odometry_error_m() const {
    double sum = 0;
    for (const Seen& frame : frames_) sum += (frame.T_world_camera.t - truth(frame.view).t).squaredNorm();
    return std::sqrt(sum / static_cast<double>(frames_.size()));
  }
  double map_error_m() const {
    double sum = 0;
    for (const Seen& frame : frames_) {
      Se3 T = frame.T_keyframe_camera;
      std::uint32_t id = frame.keyframe;
      for (; removed_.count(id) != 0; id = removed_.at(id).first) T = removed_.at(id).second * T;
      sum += ((*map.keyframe_pose(id) * T).t - truth(frame.view).t).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(frames_.size()));
  }
  // Loops that are farther from the truth than their places are apart.
  int wrong_loops() const {
    int wrong = 0;
    for (const PoseGraph::Loop& loop : map.graph().loops()) {
      const Se3& a = map.graph().node(loop.older).T_map_keyframe;
      const Se3& b = map.graph().node(loop.newer).T_map_keyframe;
      if ((a.inverse() * b).t.norm() > 0 && (loop.T_older_newer.t - (a.inverse() * b).t).norm() > 0.1)
        ++wrong;
    }
    return wrong;
  }
  static Se3 truth(int view) {
    return ProceduralSequence::T_world_camera(0).inverse() * ProceduralSequence::T_world_camera(view);
  }

  Odometry odometry;
  Map map;
  TrackResult result;
  MapResult in_map;
  int recognised = 0;
  std::int64_t allocations = 0;

 private:
  struct Seen {
    int view;
    std::uint32_t keyframe;
    Se3 T_keyframe_camera, T_world_camera;
  };
  struct Image {
    std::vector<std::uint8_t> colour;  // kHeight × kWidth × RGB
    std::vector<std::uint16_t> depth;  // kHeight × kWidth, mm
  };
  // Each view is rendered once for all tests: to render it takes as long as to track it.
  RgbdFrame frame_of(int view) {
    static std::map<int, Image> images;
    const auto [entry, is_new] = images.try_emplace(view);
    Image& image = entry->second;
    if (is_new) {
      const RgbdFrame frame = view == kDark ? sequence_.render_dark(0) : sequence_.render(view % kMirror);
      image.colour.assign(frame.colour.data, frame.colour.data + 3 * kWidth * kHeight);
      image.depth.assign(frame.depth.data, frame.depth.data + kWidth * kHeight);
      if (view >= kMirror) mirror(image);
    }
    RgbdFrame frame;
    frame.colour = {image.colour.data(), kWidth, kHeight, 3 * kWidth, PixelFormat::kRgb8};
    frame.depth = {image.depth.data(), kWidth, kHeight, kWidth, 0.001};
    return frame;
  }
  static void mirror(Image& image) {
    for (int y = 0; y < kHeight; ++y) {
      std::reverse(image.depth.begin() + y * kWidth, image.depth.begin() + (y + 1) * kWidth);
      for (int x = 0; x < kWidth / 2; ++x)
        std::swap_ranges(image.colour.begin() + 3 * (y * kWidth + x),
                         image.colour.begin() + 3 * (y * kWidth + x + 1),
                         image.colour.begin() + 3 * (y * kWidth + kWidth - 1 - x));
    }
  }

  Limits limits_{kWidth, kHeight, 250, 64, 2, 1, 0};
  Config config_;
  std::vector<std::byte> memory_, map_memory_;
  ProceduralSequence sequence_{kWidth, kHeight};
  std::vector<Seen> frames_;
  std::map<std::uint32_t, std::pair<std::uint32_t, Se3>> removed_;
  int taken_ = 0;
};

}  // namespace plvo::test
