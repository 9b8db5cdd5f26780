// SPDX-License-Identifier: Apache-2.0
// track() with a prior, on frames with known true poses: refused priors, an empty prior that changes no bit,
// a covered lens, and corrections by gravity. Also reset() and set_pose().
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "result_fingerprint.hpp"

namespace plvo {
namespace {

constexpr Limits kPriorLimits{160, 120, 250, 64};
constexpr int kPriorFrames = 24;

ProceduralSequence& sequence() {
  static ProceduralSequence instance(kPriorLimits.width, kPriorLimits.height);
  return instance;
}

Se3 truth(int i) {
  return ProceduralSequence::T_world_camera(0).inverse() * ProceduralSequence::T_world_camera(i);
}

RotationPrior gyro(int before, int now, double sigma_rad = 1e-4) {
  const Se3 T_now_before = truth(now).inverse() * truth(before);
  return {T_now_before.R, sigma_rad * sigma_rad * Matrix3::Identity()};
}
TranslationPrior wheels(int before, int now, double sigma_m = 1e-3) {
  const Se3 T_now_before = truth(now).inverse() * truth(before);
  return {T_now_before.t, sigma_m * sigma_m * Matrix3::Identity()};
}
GravityPrior level(int now, double sigma_rad = 0.01) {
  const Vector3 down_in_world(0, 1, 0);
  return {truth(now).R.transpose() * down_in_world, sigma_rad * sigma_rad * Matrix3::Identity(), 0};
}

double angle_between(const Matrix3& A, const Matrix3& B) { return rotation_log(A * B.transpose()).norm(); }
double worst(const Matrix6& C, int first) { return C.diagonal().segment<3>(first).maxCoeff(); }

struct WithPrior {
  explicit WithPrior(const Config& config = {}, const Limits& limits = kPriorLimits)
      : memory(required_bytes(limits)) {
    const Status status = odometry.init(memory, sequence().camera(), config, limits);
    EXPECT_TRUE(status.ok()) << status.message();
  }
  TrackResult track(int i, const MotionPrior& prior = {}) {
    return odometry.track(sequence().render(i), prior);
  }
  TrackResult cover(int i, const MotionPrior& prior = {}) {
    return odometry.track(sequence().render_dark(i), prior);
  }
  std::vector<std::byte> memory;
  Odometry odometry;
};

TEST(OdometryPrior, AnEmptyPriorChangesNoBit) {
  for (const bool paper : {false, true}) {
    const Config config = paper ? Config::paper() : Config();
    WithPrior without(config), with(config);
    for (int i = 0; i < 10; ++i) {
      const TrackResult expected = without.odometry.track(sequence().render(i));
      EXPECT_EQ(fingerprint(with.track(i, MotionPrior())), fingerprint(expected)) << i;
    }
  }
}

TEST(OdometryPrior, AnInvalidPriorIsRefusedWithItsFrameAndChangesNothing) {
  WithPrior without, with;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 6; ++i) {
    for (int kind = 0; kind < 3; ++kind) {
      MotionPrior bad;
      if (kind == 0) bad.rotation = {nan * Matrix3::Identity(), Matrix3::Identity()};
      if (kind == 1) bad.translation = {{0, 0, 0}, -Matrix3::Identity()};
      if (kind == 2) bad.gravity = {{0, nan, 0}, Matrix3::Identity(), 0};
      const TrackResult refused = with.track(i, bad);
      EXPECT_EQ(refused.state, TrackState::kLost);
      EXPECT_EQ(refused.status.code(), StatusCode::kInvalidArgument);
      EXPECT_NE(std::string(refused.status.message()).find("prior: "), std::string::npos);
      EXPECT_TRUE(refused.T_world_camera.is_finite());
    }
    EXPECT_EQ(fingerprint(with.track(i)), fingerprint(without.track(i)));
  }
}

TEST(OdometryPrior, AValidPriorIsOneMoreMeasurement) {
  WithPrior without, with;
  double alone = 0, helped = 0;
  for (int i = 0; i < kPriorFrames; ++i) {
    MotionPrior prior;
    if (i > 0) prior.rotation = gyro(i - 1, i, 2e-5);
    const TrackResult a = without.track(i), b = with.track(i, prior);
    ASSERT_NE(b.state, TrackState::kLost) << b.status.message();
    if (i == 0) continue;
    EXPECT_EQ(b.state, TrackState::kTracking);
    EXPECT_LT(worst(b.motion_covariance, 3), worst(a.motion_covariance, 3)) << i;
    alone += angle_between(a.T_world_camera.R, truth(i).R);
    helped += angle_between(b.T_world_camera.R, truth(i).R);
  }
  EXPECT_LT(helped, 0.6 * alone);
}

// most_left: share of the predicted variance when the keyframe is found again, without wheels and with them.
void expect_to_go_on_by_the_prior(const Config& config, double most_left, double most_left_with_wheels) {
  for (const bool with_wheels : {false, true}) {
    WithPrior instance(config);
    for (int i = 0; i < 8; ++i) ASSERT_NE(instance.track(i).state, TrackState::kLost);
    double variance_m = 0, variance_rad = 0;
    for (int i = 8; i < 14; ++i) {
      MotionPrior prior;
      prior.rotation = gyro(i - 1, i);
      if (with_wheels) prior.translation = wheels(i - 1, i);
      const TrackResult result = instance.cover(i, prior);
      EXPECT_EQ(result.state, TrackState::kPredicted);
      EXPECT_EQ(result.status.code(), StatusCode::kTooFewFeatures);
      EXPECT_EQ(std::string(result.status.message()).rfind("predicted: ", 0), 0U) << result.status.message();
      EXPECT_LT(angle_between(result.T_world_camera.R, truth(i).R), 3e-3);
      const double off = (result.T_world_camera.t - truth(i).t).norm();
      if (with_wheels) {
        EXPECT_LT(off, 0.01);
      }
      EXPECT_LT(off * off, 20 * 3 * worst(result.pose_covariance, 0)) << "as the covariance says";
      EXPECT_GT(worst(result.pose_covariance, 0), variance_m);
      EXPECT_GT(worst(result.pose_covariance, 3), variance_rad);
      variance_m = worst(result.pose_covariance, 0);
      variance_rad = worst(result.pose_covariance, 3);
    }
    MotionPrior prior;
    prior.rotation = gyro(13, 14);
    if (with_wheels) prior.translation = wheels(13, 14);
    const TrackResult again = instance.track(14, prior);
    EXPECT_EQ(again.state, TrackState::kTracking) << again.status.message();
    EXPECT_LT((again.T_world_camera.t - truth(14).t).norm(), 0.02);
    EXPECT_LT(worst(again.pose_covariance, 0), (with_wheels ? most_left_with_wheels : most_left) * variance_m)
        << "the keyframe is found again";
    if (!with_wheels) {
      EXPECT_LT(worst(again.motion_covariance, 0), 0.01 * variance_m);
    }
  }
}

TEST(OdometryPrior, PredictsAFrameThatShowsNothing) {
  Config config;
  // It contains what points and lines say apart, which may be more than what wheels leave open.
  expect_to_go_on_by_the_prior(config, 0.012, 1.4);
  config.noise.learning_rate = 0;  // the covariance then contains nothing of it
  // The common-mode error of the keyframe stays, however many frames are matched with it.
  expect_to_go_on_by_the_prior(config, 0.01, 0.9);
  config.noise.common_mode_share = 0;
  expect_to_go_on_by_the_prior(config, 0.01, 0.7);
}

TEST(OdometryPrior, AtThreeFramesASecondTheTranslationGoesOnBesideAGyro) {
  WithPrior camera;
  const auto see = [&](int i, bool covered) {
    RgbdFrame frame = covered ? sequence().render_dark(i) : sequence().render(i);
    frame.stamp_ns = frame.depth_stamp_ns = 1'000'000'000 + i * 333'333'333LL;
    MotionPrior prior;
    if (i > 0) prior.rotation = gyro(i - 1, i);
    return camera.odometry.track(frame, prior);
  };
  for (int i = 0; i < 6; ++i) (void)see(i, false);
  const TrackResult result = see(6, true);
  ASSERT_EQ(result.state, TrackState::kPredicted);
  const double step_m = (truth(6).t - truth(5).t).norm();
  EXPECT_LT((result.T_world_camera.t - truth(6).t).norm(), 0.5 * step_m);
}

TEST(OdometryPrior, AMissingPriorEndsThePrediction) {
  WithPrior instance;
  for (int i = 0; i < 4; ++i) ASSERT_NE(instance.track(i).state, TrackState::kLost);
  MotionPrior prior;
  prior.rotation = gyro(3, 4);
  EXPECT_EQ(instance.cover(4, prior).state, TrackState::kPredicted);
  EXPECT_EQ(instance.cover(5).state, TrackState::kLost);
  prior.rotation = gyro(5, 6);
  EXPECT_EQ(instance.cover(6, prior).state, TrackState::kLost) << "the motion of frame 5 is unknown";
  EXPECT_EQ(instance.track(7, prior).state, TrackState::kTracking) << "tracked again from the keyframe";
}

// The lens is covered until the references are given up. Tracking then restarts at the pose that the priors
// predict.
TEST(OdometryPrior, PredictsThroughALongCover) {
  Config config;
  config.references.max_lost_s = 0.09;
  Limits limits = kPriorLimits;
  limits.kept_keyframes = 0;  // no relocalisation at the view from before the loss
  WithPrior instance(config, limits);
  for (int i = 0; i < 6; ++i) ASSERT_NE(instance.track(i).state, TrackState::kLost);
  for (int i = 6; i < 16; ++i) {
    MotionPrior prior;
    prior.rotation = gyro(i - 1, i);
    prior.translation = wheels(i - 1, i);
    EXPECT_EQ(instance.cover(i, prior).state, TrackState::kPredicted) << i;
  }
  MotionPrior prior;
  prior.rotation = gyro(15, 16);
  prior.translation = wheels(15, 16);
  const TrackResult anew = instance.track(16, prior);
  EXPECT_EQ(anew.state, TrackState::kInitialising);
  EXPECT_TRUE(anew.status.ok()) << anew.status.message();
  EXPECT_LT((anew.T_world_camera.t - truth(16).t).norm(), 0.02);
  EXPECT_LT(angle_between(anew.T_world_camera.R, truth(16).R), 5e-3);
  EXPECT_GT(worst(anew.pose_covariance, 0), 9e-6) << "ten unobserved steps of a millimetre, independent";
  EXPECT_EQ(instance.track(17).state, TrackState::kTracking);
}

TEST(OdometryPrior, GravityLevelsATiltedPose) {
  WithPrior instance;
  MotionPrior prior;
  prior.gravity = level(0);
  ASSERT_EQ(instance.track(0, prior).state, TrackState::kInitialising);
  // From here on, the direction of gravity is known. The test then tilts the pose, as drift would.
  TrackResult result;
  for (int i = 1; i < kPriorFrames; ++i) {
    prior.gravity = level(i);
    result = instance.track(i, prior);
    ASSERT_EQ(result.state, TrackState::kTracking);
  }
  EXPECT_LT(angle_between(result.T_world_camera.R, truth(kPriorFrames - 1).R), 0.01);
  EXPECT_LT(worst(result.pose_covariance, 3), 1e-4);
}

// In a dark frame, gravity corrects only the pose of that frame; the filter's estimate stays.
TEST(OdometryPrior, GravityCorrectsAPredictedFrameToo) {
  WithPrior instance;
  MotionPrior prior;
  for (int i = 0; i < 6; ++i) {
    prior.gravity = level(i, 1e-3);
    if (i > 0) prior.rotation = gyro(i - 1, i);
    ASSERT_NE(instance.track(i, prior).state, TrackState::kLost);
  }
  RotationPrior wrong = gyro(5, 6, 0.05);
  wrong.R_now_before = rotation_exp({0.05, 0, 0.05}) * wrong.R_now_before;
  MotionPrior only_gyro, both;
  only_gyro.rotation = both.rotation = wrong;
  both.gravity = level(6, 1e-3);
  WithPrior other;
  for (int i = 0; i < 6; ++i) {
    prior = {};
    prior.gravity = level(i, 1e-3);
    if (i > 0) prior.rotation = gyro(i - 1, i);
    (void)other.track(i, prior);
  }
  const TrackResult off = other.cover(6, only_gyro), upright = instance.cover(6, both);
  EXPECT_EQ(off.state, TrackState::kPredicted);
  EXPECT_EQ(upright.state, TrackState::kPredicted);
  EXPECT_GT(angle_between(off.T_world_camera.R, truth(6).R), 0.05);
  EXPECT_LT(angle_between(upright.T_world_camera.R, truth(6).R), 0.02);
}

// The world of the sequence is tilted with respect to the level world.
TEST(OdometryLevel, TheFirstGravityDefinesTheWorld) {
  const Matrix3 R_level_truth = rotation_exp({0.3, 0, -0.2});
  const auto down = [&](int i, const Vector3& error, double sigma) {
    MotionPrior prior;
    const Vector3 y(0, 1, 0);
    prior.gravity = {truth(i).R.transpose() * R_level_truth.transpose() * y + error,
                     sigma * sigma * Matrix3::Identity(), 0};
    return prior;
  };
  Config config;
  config.level_world = true;
  WithPrior instance(config), plain;
  for (int i = 0; i < 3; ++i) {
    const TrackResult waiting = instance.track(i);
    EXPECT_EQ(waiting.state, TrackState::kInitialising);
    EXPECT_EQ(waiting.status.code(), StatusCode::kNotFound);
    EXPECT_NE(std::string(waiting.status.message()).find("waiting for gravity"), std::string::npos);
  }
  TrackResult first = instance.track(3, down(3, {0.05, 0, 0.04}, 0.06));
  ASSERT_EQ(first.state, TrackState::kInitialising);
  ASSERT_TRUE(first.status.ok()) << first.status.message();
  const Vector3 y(0, 1, 0);
  const auto tilt = [&](int i, const TrackResult& result) {
    return (result.T_world_camera.R * truth(i).R.transpose() * R_level_truth.transpose() * y - y).norm();
  };
  EXPECT_NEAR(tilt(3, first), 0.06, 0.01) << "the error of the reading";
  EXPECT_GT(worst(first.pose_covariance, 3), 0.003);
  // The motion is the same as without gravity; better readings correct the tilt.
  (void)plain.track(3);
  for (int i = 4; i < kPriorFrames; ++i) {
    const TrackResult result = instance.track(i, down(i, Vector3::Zero(), 0.01));
    const TrackResult expected = plain.track(i);
    ASSERT_EQ(result.state, TrackState::kTracking);
    EXPECT_LT(boxminus(result.T_camera_reference, expected.T_camera_reference).norm(), 2e-4) << i;
    if (i == kPriorFrames - 1) {
      EXPECT_LT(tilt(i, result), 0.01);
      EXPECT_LT(worst(result.pose_covariance, 3), 1e-4);
    }
  }
  // A pose from set_pose() takes precedence over gravity; reset() starts again.
  instance.odometry.reset();
  EXPECT_EQ(instance.track(0).status.code(), StatusCode::kNotFound);
  const Se3 mine{rotation_exp({0.1, 0.2, 0.3}), {1, 2, 3}};
  ASSERT_TRUE(instance.odometry.set_pose(mine, Matrix6::Zero()).ok());
  const TrackResult set = instance.track(1);
  EXPECT_TRUE(set.status.ok()) << set.status.message();
  EXPECT_LT(boxminus(set.T_world_camera, mine).norm(), 1e-12);
}

TEST(OdometryReset, RestoresTheStateAfterInit) {
  WithPrior fresh, used;
  for (int i = 0; i < 8; ++i) (void)used.track(i);
  used.odometry.reset();
  for (int i = 0; i < 8; ++i) EXPECT_EQ(fingerprint(used.track(i)), fingerprint(fresh.track(i))) << i;
}

TEST(OdometrySetPose, SetsTheWorldOfTheFollowingPoses) {
  WithPrior plain, moved;
  const Se3 T_new{rotation_exp({0.3, -0.4, 0.5}), {10, -20, 30}};
  Matrix6 C = Matrix6::Identity() * 1e-4;
  TrackResult a, b;
  for (int i = 0; i < 12; ++i) {
    a = plain.track(i);
    b = moved.track(i);
  }
  ASSERT_TRUE(moved.odometry.set_pose(T_new, C).ok());
  const Se3 W = T_new * b.T_world_camera.inverse();
  for (int i = 12; i < kPriorFrames; ++i) {
    a = plain.track(i);
    b = moved.track(i);
    ASSERT_EQ(b.state, TrackState::kTracking);
    const Vector6 apart = boxminus(b.T_world_camera, W * a.T_world_camera);
    EXPECT_LT(apart.cwiseAbs().maxCoeff(), 1e-6) << i;
    EXPECT_GT(worst(b.pose_covariance, 3), 0.9e-4);
  }
  // set_pose() before the first frame.
  WithPrior early;
  ASSERT_TRUE(early.odometry.set_pose(T_new, C).ok());
  const TrackResult first = early.track(0);
  EXPECT_EQ(first.T_world_camera.t, T_new.t);
  EXPECT_EQ(first.pose_covariance, C);
}

TEST(OdometrySetPose, RefusesInvalidPoses) {
  Odometry closed;
  EXPECT_EQ(closed.set_pose({}, Matrix6::Zero()).code(), StatusCode::kInvalidArgument);
  WithPrior instance;
  (void)instance.track(0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const Se3& T, const Matrix6& C) {
    EXPECT_EQ(instance.odometry.set_pose(T, C).code(), StatusCode::kInvalidArgument);
  };
  refused({nan * Matrix3::Identity(), Vector3::Zero()}, Matrix6::Zero());
  refused({2 * Matrix3::Identity(), Vector3::Zero()}, Matrix6::Zero());
  refused({Matrix3::Identity(), {0, nan, 0}}, Matrix6::Zero());
  refused({}, Matrix6(-Matrix6::Identity()));
  refused({}, Matrix6(nan * Matrix6::Identity()));
  Matrix6 skewed = Matrix6::Identity();
  skewed(0, 1) = 0.1;
  refused({}, skewed);
  // Rotations are judged by their own variances, however large those of the position are.
  for (const double other_side : {0.0, 2e-4}) {
    Matrix6 far = 1e-4 * Matrix6::Identity();
    far.diagonal().head<3>().setConstant(1e6);
    far(3, 4) = 2e-4;
    far(4, 3) = other_side;
    refused({}, far);
  }
  WithPrior other;
  (void)other.track(0);
  EXPECT_EQ(fingerprint(instance.track(1)), fingerprint(other.track(1))) << "nothing has changed";
}

}  // namespace
}  // namespace plvo
