// SPDX-License-Identifier: Apache-2.0
// Images that a sensor delivers again: repeated frames are passed over, a depth stream that stops is named,
// and a slower depth camera is no fault.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "result_fingerprint.hpp"
#include "sound.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kHalfFrame_ns = 16'666'666;

class RepeatingCamera {
 public:
  RepeatingCamera() : memory_(required_bytes(kLimits)) {
    EXPECT_TRUE(odometry.init(memory_, sequence_.camera(), {}, kLimits).ok());
  }
  // Colour of one view, depth of another.
  TrackResult see(int colour_view, int depth_view, std::int64_t stamp_ns) {
    const RgbdFrame old = sequence_.render(depth_view);
    const std::vector<std::uint16_t> depth(old.depth.data,
                                           old.depth.data + old.depth.stride * kLimits.height);
    RgbdFrame frame = sequence_.render(colour_view);
    frame.depth.data = depth.data();
    frame.stamp_ns = frame.depth_stamp_ns = stamp_ns;
    return track(frame);
  }
  TrackResult see(int view, std::int64_t stamp_ns) { return see(view, view, stamp_ns); }
  // A view whose colour has other noise in each call.
  TrackResult see_noisy(int view, std::int64_t stamp_ns) {
    RgbdFrame frame = sequence_.render(view);
    std::vector<std::uint8_t> colour(frame.colour.data,
                                     frame.colour.data + frame.colour.stride_bytes * kLimits.height);
    for (std::uint8_t& byte : colour) {
      noise_ = noise_ * 1664525U + 1013904223U;
      byte = static_cast<std::uint8_t>(byte ^ (noise_ >> 31));
    }
    frame.colour.data = colour.data();
    frame.stamp_ns = frame.depth_stamp_ns = stamp_ns;
    return track(frame);
  }
  TrackResult see_dark(std::int64_t stamp_ns) {
    RgbdFrame frame = sequence_.render_dark(0);
    frame.stamp_ns = frame.depth_stamp_ns = stamp_ns;
    return track(frame);
  }
  Odometry odometry;

 private:
  static constexpr Limits kLimits{160, 120, 250, 64};

  TrackResult track(const RgbdFrame& frame) {
    const TrackResult result = odometry.track(frame);
    EXPECT_TRUE(test::is_sound(result)) << result.status.message();
    return result;
  }

  std::vector<std::byte> memory_;
  ProceduralSequence sequence_{kLimits.width, kLimits.height};
  std::uint32_t noise_ = 1;
};

std::int64_t stamp(int i) { return ProceduralSequence::stamp_ns(i); }

double error_m(const TrackResult& result, int view) {
  const Se3 first = ProceduralSequence::T_world_camera(0);
  return (result.T_world_camera.t - (first.inverse() * ProceduralSequence::T_world_camera(view)).t).norm();
}

bool says(const TrackResult& result, const char* words) {
  return std::string(result.status.message()).find(words) != std::string::npos;
}

TEST(ImageStreams, RepeatedFramesChangeNothingAndHaveAPredictedPose) {
  RepeatingCamera twice, once;
  for (int i = 0; i < 16; ++i) {
    const TrackResult fresh = twice.see(i, stamp(i));
    EXPECT_EQ(fingerprint(fresh), fingerprint(once.see(i, stamp(i)))) << i;
    EXPECT_FALSE(fresh.repeated);
    const TrackResult again = twice.see(i, stamp(i) + kHalfFrame_ns);
    EXPECT_TRUE(again.repeated);
    EXPECT_EQ(again.state, TrackState::kTracking);
    EXPECT_TRUE(again.status.ok());
    EXPECT_TRUE(says(again, "predicted")) << again.status.message();
    EXPECT_GT(again.pose_covariance(0, 0), fresh.pose_covariance(0, 0));
    if (i < 2) continue;  // the velocity is not known at first
    const Se3 first = ProceduralSequence::T_world_camera(0).inverse();
    const Vector3 between = 0.5 * (first * ProceduralSequence::T_world_camera(i).t +
                                   first * ProceduralSequence::T_world_camera(i + 1).t);
    EXPECT_LT((again.T_world_camera.t - between).norm(), 0.015) << i;
  }
}

TEST(ImageStreams, AStillCameraWithoutNoiseIsNotLost) {
  RepeatingCamera camera;
  TrackResult result;
  for (int i = 0; i < 6; ++i) result = camera.see(i, stamp(i));
  double variance = result.pose_covariance(0, 0);
  for (int i = 6; i < 66; ++i) {
    result = camera.see(5, stamp(i));
    ASSERT_EQ(result.state, TrackState::kTracking);
    EXPECT_TRUE(result.repeated);
    EXPECT_GT(result.pose_covariance(0, 0), variance) << "the motion is not observed";
    variance = result.pose_covariance(0, 0);
    EXPECT_LT(error_m(result, 5), 0.03) << "the velocity is not continued for long";
  }
  result = camera.see(6, stamp(66));
  EXPECT_EQ(result.state, TrackState::kTracking) << result.status.message();
  EXPECT_FALSE(result.repeated);
  EXPECT_LT(error_m(result, 6), 0.02);
  EXPECT_LT(result.pose_covariance(0, 0), 1e-3);
}

TEST(ImageStreams, ARepeatedLostFrameStaysLost) {
  RepeatingCamera camera;
  for (int i = 0; i < 4; ++i) (void)camera.see(i, stamp(i));
  for (int i = 4; i < 8; ++i) {
    const TrackResult result = camera.see_dark(stamp(i));
    EXPECT_EQ(result.state, TrackState::kLost);
    EXPECT_FALSE(result.repeated);
  }
}

TEST(ImageStreams, ADepthStreamThatStopsIsNamedAndTheFramesAreLost) {
  RepeatingCamera camera;
  TrackResult result;
  for (int i = 0; i < 6; ++i) result = camera.see(i, stamp(i));
  int lost = 0;
  for (int i = 6; i < 18; ++i) {
    result = camera.see(i, 5, stamp(i));
    if (result.state != TrackState::kLost) {
      EXPECT_EQ(lost, 0) << "lost until new depth comes";
      continue;
    }
    ++lost;
    EXPECT_EQ(result.status.code(), StatusCode::kDamaged);
    EXPECT_TRUE(says(result, "the depth stream has stopped")) << result.status.message();
  }
  EXPECT_GE(lost, 5);
  for (int i = 18; i < 22; ++i) result = camera.see(i, stamp(i));
  EXPECT_EQ(result.state, TrackState::kTracking) << result.status.message();
  EXPECT_LT(error_m(result, 21), 0.05);
}

// A lost frame with old depth and the next one agree on a motion. The frames are lost all the same, and
// nothing has moved: the pose is that of the last good frame, and tracking goes on from it.
TEST(ImageStreams, ADepthStreamThatStopsWhileLostChangesNothing) {
  constexpr int kElsewhere = 60;  // a view that shares nothing with those before
  RepeatingCamera camera;
  TrackResult before;
  for (int i = 0; i < 7; ++i) before = camera.see(i, stamp(i));
  ASSERT_EQ(before.state, TrackState::kTracking);
  const std::int64_t reference = before.reference_stamp_ns;
  for (int i = 0; i < 2; ++i) {
    const TrackResult lost = camera.see(kElsewhere + i, 6, stamp(14 + i));
    EXPECT_EQ(lost.state, TrackState::kLost) << i;
    EXPECT_EQ(lost.T_world_camera.t, before.T_world_camera.t) << i;
    EXPECT_EQ(lost.pose_covariance, before.pose_covariance) << i;
    EXPECT_EQ(lost.reference_stamp_ns, reference) << i;
    EXPECT_EQ(says(lost, "the depth stream has stopped"), i == 1) << lost.status.message();
  }
  const TrackResult result = camera.see(7, stamp(16));
  EXPECT_EQ(result.state, TrackState::kTracking) << result.status.message();
  EXPECT_EQ(result.reference_stamp_ns, reference);
  EXPECT_LT(error_m(result, 7), 0.02);
}

TEST(ImageStreams, DepthAtHalfTheRateOfColourIsNoFault) {
  RepeatingCamera camera;
  TrackResult result;
  for (int i = 0; i < 24; ++i) {
    result = camera.see(i, i - i % 2, stamp(i));
    EXPECT_NE(result.state, TrackState::kLost) << i << ": " << result.status.message();
    EXPECT_FALSE(result.repeated);
  }
  std::printf("%.1f mm beside the truth\n", 1e3 * error_m(result, 23));
  EXPECT_LT(error_m(result, 23), 0.05);
}

TEST(ImageStreams, DepthWithoutNoiseIsNoFaultWhileTheCameraStandsStill) {
  RepeatingCamera camera;
  for (int i = 0; i < 6; ++i) (void)camera.see(i, stamp(i));
  for (int i = 6; i < 40; ++i) {
    const TrackResult result = camera.see_noisy(5, stamp(i));
    EXPECT_EQ(result.state, TrackState::kTracking) << i << ": " << result.status.message();
    EXPECT_FALSE(result.repeated);
  }
}

}  // namespace
}  // namespace plvo
