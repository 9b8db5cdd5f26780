// SPDX-License-Identifier: Apache-2.0
// A camera in the room of the procedural sequence. Each frame shows the view that a test asks for, and is
// tracked at once.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "sound.hpp"

namespace plvo::test {

class ProceduralCamera {
 public:
  static constexpr int kDark = -1;  // a view that shows nothing

  ProceduralCamera(int kept_keyframes, const Config& config, std::int64_t interval_ns)
      : interval_ns_(interval_ns) {
    limits_.kept_keyframes = kept_keyframes;
    memory_.resize(required_bytes(limits_));
    const Status status = odometry.init(memory_, sequence_.camera(), config, limits_);
    EXPECT_TRUE(status.ok()) << status.message();
  }
  // Tracks frame `view` of the sequence, taken now.
  TrackResult see(int view) {
    RgbdFrame frame = view == kDark ? sequence_.render_dark(0) : sequence_.render(view);
    frame.stamp_ns = frame.depth_stamp_ns = ProceduralSequence::stamp_ns(0) + interval_ns_ * taken_++;
    const TrackResult result = odometry.track(frame);
    EXPECT_TRUE(is_sound(result)) << result.status.message();
    return result;
  }
  // No frame comes for this many frames' time.
  void pause(int frames) { taken_ += frames; }

  Odometry odometry;

 private:
  std::int64_t interval_ns_;
  Limits limits_{160, 120, 250, 64};
  std::vector<std::byte> memory_;
  ProceduralSequence sequence_{160, 120};
  int taken_ = 0;
};

// The error of the pose, in a world that view 0 defines.
inline Vector6 pose_error(const TrackResult& result, int view) {
  const Se3 first = ProceduralSequence::T_world_camera(0);
  return boxminus(result.T_world_camera, first.inverse() * ProceduralSequence::T_world_camera(view));
}

}  // namespace plvo::test
