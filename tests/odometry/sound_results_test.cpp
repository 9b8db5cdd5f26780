// SPDX-License-Identifier: Apache-2.0
// Results are finite and covariances are valid for any stamps: after a gap of years, in the new world that
// starts then, and over a long sequence of random events.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/math/covariance.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "sound.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kSoundSecond_ns = 1'000'000'000;
constexpr std::int64_t kSoundFrame_ns = kSoundSecond_ns / 30;
constexpr int kNothing = -1;  // a view that shows nothing

class SmallCamera {
 public:
  explicit SmallCamera(Config config = {}, const Limits& limits = kSmallest)
      : memory_(required_bytes(limits)) {
    config.references.max_lost_s = 0.03;
    const Status status = odometry.init(memory_, sequence_.camera(), config, limits);
    EXPECT_TRUE(status.ok()) << status.message();
  }
  // Tracks a view of the sequence, after_ns after the previous one.
  TrackResult see(int view, std::int64_t after_ns = kSoundFrame_ns, const MotionPrior& prior = {}) {
    RgbdFrame frame = view == kNothing ? sequence_.render_dark(0) : sequence_.render(view);
    stamp_ns_ += after_ns;
    frame.stamp_ns = frame.depth_stamp_ns = stamp_ns_;
    const TrackResult result = odometry.track(frame, prior);
    EXPECT_TRUE(test::is_sound(result)) << "view " << view << " after " << after_ns << " ns, "
                                        << to_string(result.state) << ": " << result.status.message() << "\n"
                                        << result.pose_covariance;
    return result;
  }
  static constexpr Limits kSmallest{.width = 96, .height = 72, .keypoints = 400, .surfaces = 0};
  Odometry odometry;

 private:
  std::vector<std::byte> memory_;
  ProceduralSequence sequence_{kSmallest.width, kSmallest.height};
  std::int64_t stamp_ns_ = 0;
};

// Prior of a gyro and an accelerometer, for a camera that moved from `before` to `view`.
MotionPrior surely(int before, int view) {
  MotionPrior prior;
  const Matrix3 R_now = ProceduralSequence::T_world_camera(view).R.transpose();
  prior.rotation = {renormalise(R_now * ProceduralSequence::T_world_camera(before).R),
                    1e-6 * Matrix3::Identity()};
  prior.gravity = {R_now * Vector3(0, 1, 0), 1e-4 * Matrix3::Identity(), 0.02};
  return prior;
}

// Four good frames, and four that show nothing.
void lose(SmallCamera& camera) {
  for (int i = 0; i < 4; ++i) (void)camera.see(i, kSoundFrame_ns, surely(i > 0 ? i - 1 : 0, i));
  for (int i = 0; i < 4; ++i) (void)camera.see(kNothing, kSoundFrame_ns, surely(3, 3));
}
MotionPrior gravity_alone(int view) {
  MotionPrior prior = surely(view, view);
  prior.rotation.reset();
  return prior;
}

TEST(SoundResults, SurviveAGapOfYearsAfterALoss) {
  for (const std::int64_t gap_s :
       {10'000'000LL, 100'000'000LL, 300'000'000LL, 1'800'000'000LL, 4'000'000'000LL})
    for (const int view : {4, 25, 60}) {
      SCOPED_TRACE(testing::Message() << "gap " << gap_s << " s");
      SmallCamera camera;
      lose(camera);
      (void)camera.see(view, gap_s * kSoundSecond_ns, gravity_alone(view));
      for (int i = view + 1; i < view + 12; ++i) (void)camera.see(i, kSoundFrame_ns, surely(i - 1, i));
    }
}

// Half a metre per second is a kilometre after 2000 s.
TEST(SoundResults, AnUnboundedPositionStartsANewWorld) {
  for (const bool with_gravity : {false, true})
    for (const bool far : {false, true}) {
      SmallCamera camera;
      lose(camera);
      const TrackResult before = camera.see(kNothing);
      EXPECT_EQ(before.state, TrackState::kLost) << "no prior came with it";
      const TrackResult start = camera.see(60, (far ? 2100 : 1900) * kSoundSecond_ns,
                                           with_gravity ? gravity_alone(60) : MotionPrior());
      EXPECT_EQ(start.state, TrackState::kInitialising);
      EXPECT_TRUE(start.status.ok());
      EXPECT_EQ(std::string(start.status.message()).rfind("a new world starts: ", 0) == 0, far)
          << start.status.message();
      EXPECT_EQ(start.world, far ? 1U : 0U);
      EXPECT_EQ(start.restarted, !far);
      if (far) {
        EXPECT_TRUE(start.T_world_camera.t.isZero());
        EXPECT_TRUE(start.pose_covariance.isZero());
      } else {
        EXPECT_LT((start.T_world_camera.t - before.T_world_camera.t).norm(), 1e-3) << "the last good pose";
        EXPECT_GT(start.pose_covariance(0, 0), 0.8 * kMostPositionVariance);
        // Gravity bounds roll and pitch, in spite of the unobserved rotation.
        EXPECT_EQ(start.pose_covariance.diagonal().tail<3>().minCoeff() < 0.1, with_gravity);
      }
      const TrackResult next = camera.see(61);
      EXPECT_EQ(next.state, TrackState::kTracking) << next.status.message();
      EXPECT_STREQ(next.status.message(), "");
      if (far) {
        EXPECT_LT(next.pose_covariance.diagonal().maxCoeff(), 0.1) << "of the new world";
      }
    }
}

TEST(SoundResults, ANewLevelWorldWaitsForGravity) {
  Config config;
  config.level_world = true;
  SmallCamera camera(config);
  lose(camera);
  const TrackResult waiting = camera.see(60, 1'000'000 * kSoundSecond_ns);
  EXPECT_EQ(waiting.state, TrackState::kInitialising);
  EXPECT_EQ(waiting.status.code(), StatusCode::kNotFound) << waiting.status.message();
  EXPECT_TRUE(waiting.T_world_camera.t.isZero());
  EXPECT_EQ(waiting.world, 1U);
  const MotionPrior gravity = gravity_alone(61);
  const TrackResult start = camera.see(61, kSoundFrame_ns, gravity);
  EXPECT_EQ(std::string(start.status.message()).rfind("a new world starts: ", 0), 0U)
      << start.status.message();
  EXPECT_EQ(start.world, 1U) << "the frame that waited was of this world";
  EXPECT_LT((start.T_world_camera.R * gravity.gravity->down - Vector3(0, 1, 0)).norm(), 1e-9);
}

TEST(SoundResults, EveryResultIsCheckedOnReturn) {
  TrackResult result;
  EXPECT_TRUE(make_sound(result));
  result.pose_covariance = Matrix6::Identity() * 1e9;
  result.motion_covariance(0, 1) = 1;
  EXPECT_TRUE(make_sound(result));
  EXPECT_TRUE(test::is_sound_covariance(result.pose_covariance));
  EXPECT_TRUE(test::is_sound_covariance(result.motion_covariance));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](auto spoil) {
    TrackResult bad;
    spoil(bad);
    return !make_sound(bad);
  };
  EXPECT_TRUE(refused([&](TrackResult& bad) { bad.T_world_camera.t.x() = nan; }));
  EXPECT_TRUE(refused([&](TrackResult& bad) { bad.T_camera_reference.R(1, 1) = 1.001; }));
  EXPECT_TRUE(refused([&](TrackResult& bad) { bad.pose_covariance(5, 5) = 1 / 0.0; }));
  EXPECT_TRUE(refused([&](TrackResult& bad) { bad.motion_covariance(0, 5) = nan; }));
  EXPECT_TRUE(refused([&](TrackResult& bad) { bad.mean_brightness = nan; }));
  EXPECT_TRUE(refused([&](TrackResult& bad) { bad.disagreement = nan; }));
}

TEST(SoundResults, SetPoseBoundsTheCovariance) {
  SmallCamera camera;
  (void)camera.see(0);
  int view = 0;
  for (const double variance : {1e6, 1e7, 1e300}) {
    const Status status =
        camera.odometry.set_pose({Matrix3::Identity(), {1e7, -1e7, 0}}, variance * Matrix6::Identity());
    EXPECT_TRUE(status.ok()) << status.message();
    const TrackResult result = camera.see(++view);
    EXPECT_EQ(result.state, TrackState::kTracking);
    EXPECT_EQ(result.world, 0U);
    EXPECT_NEAR(result.pose_covariance(0, 0), kMostPositionVariance, 1);
  }
  EXPECT_EQ(camera.odometry.set_pose({Matrix3::Identity(), {1e9, 0, 0}}, Matrix6::Zero()).code(),
            StatusCode::kInvalidArgument);
}

// Random events: views that continue or jump, darkness, stamps from a nanosecond to years apart, priors of
// every kind and precision, set_pose(), and reset().
TEST(SoundResults, SurviveALongSequenceOfRandomEvents) {
  Limits limits = SmallCamera::kSmallest;
  limits.references = 3;
  limits.kept_keyframes = 2;
  std::uint32_t worlds = 0;  // number of worlds that follow another one
  for (int run = 0; run < 4; ++run) {
    Config config;
    config.references.policy = static_cast<ReferencePolicy>(run);
    config.level_world = run % 2 == 1;
    SmallCamera camera(config, limits);
    Random random(static_cast<std::uint64_t>(run) + 1);
    const auto any = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random.below(1001)) / 1000;
    };
    const auto variance = [&] {  // 1e-16 … 1e6
      double value = 1e-16;
      for (std::uint32_t n = random.below(23); n > 0; --n) value *= 10;
      return std::min(value, 1e6);
    };
    int before = 0, view = 0, tracked = 0;
    std::uint32_t world = 0;
    bool dark = false;
    for (int i = 0; i < 400; ++i) {
      before = view;
      view = random.below(12) == 0 ? static_cast<int>(random.below(100)) : view + 1;
      std::int64_t after_ns = kSoundFrame_ns;
      if (random.below(8) == 0) {
        after_ns = 1;
        for (std::uint32_t n = random.below(18); n > 0; --n) after_ns *= 10;
      }
      MotionPrior prior = surely(before, view);
      prior.rotation->covariance = variance() * Matrix3::Identity();
      prior.gravity->covariance = variance() * Matrix3::Identity();
      prior.gravity->offset_sigma = any(0, 1);
      if (random.below(4) == 0) prior.gravity->down = Vector3(any(-1, 1), any(-1, 1), 2);
      if (random.below(3) == 0)
        prior.translation = {Vector3(any(-1, 1), any(-1, 1), any(-1, 1)), variance() * Matrix3::Identity()};
      if (random.below(3) == 0) prior.rotation.reset();
      if (random.below(3) == 0) prior.gravity.reset();
      if (random.below(40) == 0) camera.odometry.reset();
      if (random.below(20) == 0) {
        const Status status = camera.odometry.set_pose(ProceduralSequence::T_world_camera(view),
                                                       variance() * Matrix6::Identity());
        EXPECT_TRUE(status.ok()) << status.message();
      }
      if (random.below(dark ? 4 : 10) == 0) dark = !dark;
      const TrackResult result = camera.see(dark ? kNothing : view, after_ns, prior);
      tracked += result.state == TrackState::kTracking ? 1 : 0;
      EXPECT_LE(result.world - world, 1U) << "it rises by one";
      world = result.world;
      if (testing::Test::HasFailure()) return;
    }
    EXPECT_GT(tracked, 50) << "run " << run;
    worlds += world;
  }
  EXPECT_GT(worlds, 3U);
}

}  // namespace
}  // namespace plvo
