// SPDX-License-Identifier: Apache-2.0
// The public API: what init and track refuse, how they treat frames that show nothing, and that results are
// finite for any content of a frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "result_fingerprint.hpp"

namespace plvo {
namespace {

constexpr Limits kStateLimits{160, 120, 250, 64,
                              2,   1,   0};  // no keyframe is kept: recovery_test.cpp tests that
static_assert(required_bytes(Limits::vga()) <= 8 * 1024 * 1024);

bool contains(const Status& status, const std::string& text) {
  return std::string(status.message()).find(text) != std::string::npos;
}

bool finite(const TrackResult& result) {
  return result.T_world_camera.R.allFinite() && result.T_world_camera.t.allFinite() &&
         result.pose_covariance.allFinite() && result.T_camera_reference.R.allFinite() &&
         result.T_camera_reference.t.allFinite() && result.motion_covariance.allFinite() &&
         std::isfinite(result.mean_brightness);
}

bool same_pose(const TrackResult& a, const TrackResult& b) {
  return a.T_world_camera.R == b.T_world_camera.R && a.T_world_camera.t == b.T_world_camera.t;
}

// Renders each frame once for the whole program. A copy owns its pixels, so a test may change it.
class Recorded {
 public:
  explicit Recorded(const RgbdFrame& frame)
      : colour(frame.colour.data, frame.colour.data + frame.colour.stride_bytes * frame.colour.height),
        depth(frame.depth.data, frame.depth.data + frame.depth.stride * frame.depth.height),
        frame_(frame) {}
  RgbdFrame frame() const {
    RgbdFrame frame = frame_;
    frame.colour.data = colour.data();
    frame.depth.data = depth.data();
    return frame;
  }
  std::vector<std::uint8_t> colour;
  std::vector<std::uint16_t> depth;

 private:
  RgbdFrame frame_;
};

constexpr int kStateFrames = 24;
const CameraModel& camera() {
  static const CameraModel model = ProceduralSequence(kStateLimits.width, kStateLimits.height).camera();
  return model;
}
const Recorded& recorded(int i) {
  static const std::vector<Recorded> all = [] {
    ProceduralSequence sequence(kStateLimits.width, kStateLimits.height);
    std::vector<Recorded> frames;
    for (int k = 0; k < kStateFrames; ++k) frames.emplace_back(sequence.render(k));
    return frames;
  }();
  return all.at(static_cast<std::size_t>(i));
}
RgbdFrame good(int i) { return recorded(i).frame(); }

Recorded dark(int i) {
  Recorded frame = recorded(i);
  frame.colour.assign(frame.colour.size(), 2);
  return frame;
}
Recorded blind(int i) {
  Recorded frame = recorded(i);
  frame.depth.assign(frame.depth.size(), 0);
  return frame;
}

struct Instance {
  explicit Instance(const Config& config = {}, std::size_t misaligned_by = 0)
      : memory(required_bytes(kStateLimits) + misaligned_by) {
    status = odometry.init(std::span(memory).subspan(misaligned_by), camera(), config, kStateLimits);
  }
  TrackResult track(const RgbdFrame& frame) {
    const TrackResult result = odometry.track(frame);
    EXPECT_TRUE(finite(result));
    EXPECT_EQ(result.stamp_ns, frame.stamp_ns);
    // The status has a message exactly if something went wrong.
    if (result.state == TrackState::kTracking) {
      EXPECT_TRUE(result.status.ok()) << result.status.message();
    }
    if (result.state == TrackState::kLost) {
      EXPECT_FALSE(result.status.ok());
      EXPECT_GT(std::string(result.status.message()).size(), 10U);
    }
    return result;
  }
  std::vector<std::byte> memory;
  Odometry odometry;
  Status status;
};

double position_error(const TrackResult& result, int i) {
  const Se3 first = ProceduralSequence::T_world_camera(0);
  const Se3 truth = first.inverse() * ProceduralSequence::T_world_camera(i);
  return (result.T_world_camera.t - truth.t).norm();
}

TEST(OdometryInit, StatesTheRequiredSizeForATooSmallBlock) {
  std::vector<std::byte> memory(required_bytes(kStateLimits) - 1);
  Odometry odometry;
  const Status status = odometry.init(memory, camera(), {}, kStateLimits);
  EXPECT_EQ(status.code(), StatusCode::kOutOfMemory);
  EXPECT_TRUE(contains(status, std::to_string(required_bytes(kStateLimits)))) << status.message();
  EXPECT_EQ(odometry.track(good(0)).status.code(), StatusCode::kInvalidArgument) << "it stays uninitialised";
}

TEST(OdometryInit, RefusesInvalidArgumentsByName) {
  std::vector<std::byte> memory(required_bytes(kStateLimits));
  Odometry odometry;
  const auto init = [&](const CameraModel& c, const Config& config, const Limits& limits) {
    const Status status = odometry.init(memory, c, config, limits);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument) << status.message();
    return status;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CameraModel bad_camera = camera();
  bad_camera.pinhole.fx = nan;
  (void)init(bad_camera, {}, kStateLimits);
  bad_camera = camera();
  bad_camera.distortion.k1 = nan;
  (void)init(bad_camera, {}, kStateLimits);

  Config config;
  config.points.sigma_px = nan;
  EXPECT_TRUE(contains(init(camera(), config, kStateLimits), "points.sigma_px"));
  config = {};
  config.motion.min_inliers = 2;
  EXPECT_TRUE(contains(init(camera(), config, kStateLimits), "motion.min_inliers"));
  config = {};
  config.points.depth_reach_px = 4;
  EXPECT_TRUE(contains(init(camera(), config, kStateLimits), "points.depth_reach_px"));
  config = {};
  config.depth_noise.c1 = nan;
  EXPECT_TRUE(contains(init(camera(), config, kStateLimits), "depth_noise"));

  EXPECT_TRUE(contains(init(camera(), {}, {159, 120, 250, 64}), "160x120"))
      << "smaller than the camera's image";
  EXPECT_TRUE(contains(init(camera(), {}, {160, 120, 0, 64}), "keypoints"));
  EXPECT_TRUE(contains(init(camera(), {}, {160, 120, 250, -1}), "segments"));
  EXPECT_TRUE(contains(init(camera(), {}, {4000, 120, 250, 64}), "width"));
  // A valid init succeeds afterwards.
  EXPECT_TRUE(odometry.init(memory, camera(), {}, kStateLimits).ok());
  EXPECT_EQ(odometry.track(good(0)).state, TrackState::kInitialising);
}

TEST(OdometryTrack, IsRefusedBeforeInit) {
  Odometry odometry;
  const TrackResult result = odometry.track(good(0));
  EXPECT_EQ(result.state, TrackState::kLost);
  EXPECT_EQ(result.status.code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(contains(result.status, "init"));
  EXPECT_TRUE(finite(result));
  EXPECT_TRUE(odometry.features().keypoints.empty());
}

TEST(OdometryTrack, ARefusedFrameChangesNothing) {
  Instance disturbed, undisturbed;
  ASSERT_TRUE(disturbed.status.ok()) << disturbed.status.message();
  for (int i = 0; i < 6; ++i) {
    const TrackResult expected = undisturbed.track(good(i));
    const TrackResult result = disturbed.track(good(i));
    EXPECT_EQ(fingerprint(result), fingerprint(expected)) << i;
    std::vector<RgbdFrame> bad(12, good(i + 1));
    bad[0].colour.data = nullptr;
    bad[1].depth.data = nullptr;
    bad[2].colour.width -= 1;
    bad[3].depth.height += 1;
    bad[4].colour.stride_bytes = 3 * kStateLimits.width - 1;
    bad[5].depth.stride = 0;
    bad[6].depth.metres_per_unit = 0;
    bad[7].depth.metres_per_unit = std::numeric_limits<double>::quiet_NaN();
    bad[8].depth.metres_per_unit = 1e-300;
    bad[9].stamp_ns = good(i).stamp_ns;       // the same stamp twice
    bad[10].stamp_ns = good(i).stamp_ns - 1;  // a stamp in the past
    bad[11].stamp_ns = std::numeric_limits<std::int64_t>::min();
    for (std::size_t k = 0; k < bad.size(); ++k) {
      const TrackResult refused = disturbed.track(bad[k]);
      EXPECT_EQ(refused.state, TrackState::kLost) << k;
      EXPECT_EQ(refused.status.code(), StatusCode::kInvalidArgument) << k;
      EXPECT_TRUE(same_pose(refused, result)) << k;
      EXPECT_EQ(refused.pose_covariance, result.pose_covariance) << k;
    }
  }
}

TEST(OdometryTrack, EveryChoiceOfFeaturesTracks) {
  for (Features features : {Features::kPoints, Features::kLines, Features::kBoth}) {
    Config config;
    config.features = features;
    Instance instance(config);
    TrackResult result;
    int tracked = 0;
    for (int i = 0; i < 10; ++i) {
      result = instance.track(good(i));
      tracked += result.state == TrackState::kTracking ? 1 : 0;
      if (features == Features::kLines) {
        EXPECT_EQ(result.points.detected + result.points.matched, 0);
      }
      if (features == Features::kPoints) {
        EXPECT_EQ(result.lines.detected + result.lines.matched, 0);
      }
    }
    SCOPED_TRACE(testing::Message() << "features " << static_cast<int>(features));
    // An image of 160×120 contains few lines.
    EXPECT_GE(tracked, features == Features::kLines ? 5 : 9) << result.status.message();
    if (features != Features::kLines) {
      EXPECT_LT(position_error(result, 9), 0.05);
    }
  }
}

TEST(OdometryTrack, RecoversTheSamePoseAfterDarkness) {
  for (bool no_depth : {false, true}) {
    Instance instance;
    TrackResult before;
    for (int i = 0; i < 5; ++i) before = instance.track(good(i));
    ASSERT_EQ(before.state, TrackState::kTracking);
    for (int i = 5; i < 7; ++i) {
      const Recorded frame = no_depth ? blind(i) : dark(i);
      const TrackResult lost = instance.track(frame.frame());
      EXPECT_EQ(lost.state, TrackState::kLost);
      EXPECT_TRUE(contains(lost.status, "lost: hardly anything to see")) << lost.status.message();
      EXPECT_TRUE(same_pose(lost, before));
      EXPECT_EQ(lost.pose_covariance, before.pose_covariance);
    }
    const TrackResult after = instance.track(good(7));
    EXPECT_EQ(after.state, TrackState::kTracking) << after.status.message();
    EXPECT_EQ(after.reference_stamp_ns, before.reference_stamp_ns) << "the keyframe is kept";
    EXPECT_LT(position_error(after, 7), 0.05);
  }
}

TEST(OdometryTrack, WaitsForAFirstUsableFrame) {
  Instance instance;
  for (int i = 0; i < 3; ++i) {
    const Recorded frame = dark(i);
    const TrackResult result = instance.track(frame.frame());
    EXPECT_EQ(result.state, TrackState::kInitialising);
    EXPECT_EQ(result.status.code(), StatusCode::kTooFewFeatures);
  }
  EXPECT_TRUE(instance.track(good(3)).status.ok());
  EXPECT_EQ(instance.track(good(4)).state, TrackState::kTracking);
}

TEST(OdometryTrack, RestartsAtTheLastPoseWithALargerCovarianceAfterALongLoss) {
  // The loss lasts from the last good frame to the first one after it, not only until the reference is given
  // up.
  for (int dark_frames : {4, 12}) {
    Config config;
    config.references.max_lost_s = 0.09;
    Instance instance(config);
    TrackResult before;
    double largest_step = 0;
    for (int i = 0; i < 4; ++i) {
      const Se3 last = before.T_world_camera;
      before = instance.track(good(i));
      largest_step = std::max(largest_step, boxminus(before.T_world_camera, last).norm());
    }
    for (int i = 4; i < 4 + dark_frames; ++i) {
      const Recorded frame = dark(i);
      const TrackResult lost = instance.track(frame.frame());
      EXPECT_FALSE(lost.status.ok());
      EXPECT_EQ(lost.state, TrackState::kLost) << "also when the reference has been given up";
      EXPECT_TRUE(same_pose(lost, before));
    }
    const int i = 4 + dark_frames;
    const TrackResult anew = instance.track(good(i));
    EXPECT_EQ(anew.state, TrackState::kInitialising);
    EXPECT_TRUE(anew.status.ok()) << anew.status.message();
    EXPECT_TRUE(same_pose(anew, before));
    const double seconds = static_cast<double>(good(i).stamp_ns - before.stamp_ns) * 1e-9;
    const std::int64_t step_ns = good(1).stamp_ns - good(0).stamp_ns;
    const Velocity measured{Vector6::Zero(), step_ns};
    const double longest_way = largest_step * measured.moving_s(good(i).stamp_ns - before.stamp_ns) /
                               (static_cast<double>(step_ns) * 1e-9);
    for (int k = 0; k < 6; ++k) {
      const double rate =
          k < 3 ? config.references.process_noise_m_per_s : config.references.process_noise_rad_per_s;
      const double least = before.pose_covariance(k, k) + (rate * seconds) * (rate * seconds);
      EXPECT_GE(anew.pose_covariance(k, k), (1 - 1e-9) * least);
      // The camera may have gone on as before, for as long as a velocity counts.
      EXPECT_LE(anew.pose_covariance(k, k), least + 1.01 * longest_way * longest_way);
    }
    const TrackResult next = instance.track(good(i + 1));
    EXPECT_EQ(next.state, TrackState::kTracking) << next.status.message();
    EXPECT_GT(next.pose_covariance(0, 0), before.pose_covariance(0, 0));
  }
}

TEST(OdometryTrack, RandomFramesGiveFiniteResults) {
  Config config;
  config.references.max_lost_s = 0.06;
  Instance instance(config);
  Random random(666);
  ASSERT_EQ(instance.track(good(0)).state, TrackState::kInitialising);
  for (int i = 1; i < 18; ++i) {
    Recorded frame = recorded(i);
    const bool spoil_colour = i % 3 != 0;
    const bool spoil_depth = i % 3 != 1;
    if (spoil_colour)
      for (std::uint8_t& byte : frame.colour) byte = static_cast<std::uint8_t>(random.below(256));
    if (spoil_depth)
      for (std::uint16_t& unit : frame.depth)
        unit = static_cast<std::uint16_t>(i % 2 == 0 ? random.below(65536) : random.below(3) * 32767);
    RgbdFrame view = frame.frame();
    view.depth.metres_per_unit = i % 5 == 0 ? 0.99 : i % 5 == 1 ? 1e-6 : 0.001;
    (void)instance.track(view);  // checks that the result is finite
  }
  TrackResult result;
  for (int i = 18; i < kStateFrames; ++i) result = instance.track(good(i));
  EXPECT_EQ(result.state, TrackState::kTracking) << result.status.message();
}

TEST(OdometryTrack, AcceptsAnyIncreasingStamps) {
  Instance instance;
  const std::int64_t stamps[] = {
      std::numeric_limits<std::int64_t>::min(), -5, 0, 1, std::numeric_limits<std::int64_t>::max() - 1,
      std::numeric_limits<std::int64_t>::max()};
  for (int i = 0; i < 6; ++i) {
    RgbdFrame frame = good(i);
    frame.stamp_ns = stamps[i];
    EXPECT_EQ(instance.track(frame).state, i == 0 ? TrackState::kInitialising : TrackState::kTracking) << i;
  }
}

TEST(OdometryTrack, KeepsAKeyframeWhileItHasEnoughInliers) {
  const auto references = [](ReferencePolicy policy, double ratio) {
    Config config;
    config.references.policy = policy;
    config.references.keyframe_inlier_ratio = ratio;
    Instance instance(config);
    std::vector<std::int64_t> stamps;
    for (int i = 0; i < 12; ++i) {
      const TrackResult result = instance.track(good(i));
      EXPECT_NE(result.state, TrackState::kLost) << result.status.message();
      stamps.push_back(result.reference_stamp_ns);
    }
    return stamps;
  };
  const std::vector<std::int64_t> previous = references(ReferencePolicy::kPreviousFrame, 0.5);
  for (int i = 1; i < 12; ++i) EXPECT_EQ(previous[static_cast<std::size_t>(i)], good(i - 1).stamp_ns);
  // With a ratio of 1 every keyframe is replaced; with 0 the first one stays.
  EXPECT_EQ(references(ReferencePolicy::kKeyframe, 1), previous);
  for (std::int64_t stamp : references(ReferencePolicy::kKeyframe, 0)) EXPECT_EQ(stamp, good(0).stamp_ns);
  // With a ratio in between the keyframe changes sometimes, and never back.
  const std::vector<std::int64_t> some = references(ReferencePolicy::kKeyframe, 0.4);
  int changes = 0;
  for (std::size_t i = 1; i < some.size(); ++i) {
    EXPECT_GE(some[i], some[i - 1]);
    changes += some[i] != some[i - 1] ? 1 : 0;
  }
  EXPECT_LT(changes, 11);
}

TEST(OdometryTrack, GivesTheSameBitsInAnyInstanceAndBlock) {
  Instance one;
  Instance other({}, 13);
  ASSERT_TRUE(other.status.ok()) << other.status.message();
  for (std::byte& byte : other.memory) byte = std::byte{0xcd};
  // The previous content of the block does not matter either.
  ASSERT_TRUE(other.odometry.init(std::span(other.memory).subspan(13), camera(), {}, kStateLimits).ok());
  for (int i = 0; i < 8; ++i) {
    const Recorded night = dark(i);
    const RgbdFrame frame = i == 5 ? night.frame() : good(i);
    EXPECT_EQ(fingerprint(one.track(frame)), fingerprint(other.track(frame))) << i;
  }
}

}  // namespace
}  // namespace plvo
