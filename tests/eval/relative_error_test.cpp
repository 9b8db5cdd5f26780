// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/relative_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "plvo/eval/evaluation.hpp"

namespace plvo::eval {
namespace {

// A trajectory at 30 Hz along x at 0.3 m/s; the estimate moves `scale` as far and rotates by `turn_deg` per
// frame.
PairedPoses straight_trajectory(int frames, double scale, double turn_deg) {
  PairedPoses poses;
  const Se3 true_step{Matrix3::Identity(), Vector3(0.01, 0, 0)};
  const Se3 step{rotation_exp(Vector3(0, 0, turn_deg * 3.14159265358979 / 180)), Vector3(0.01 * scale, 0, 0)};
  Se3 truth, estimate;
  for (int i = 0; i < frames; ++i) {
    poses.stamps_ns.push_back(i * 33'333'333LL);
    poses.truth.push_back(truth);
    poses.estimate.push_back(estimate);
    truth = truth * true_step;
    estimate = estimate * step;
  }
  return poses;
}

RpeDelta delta(const char* text) {
  RpeDelta result;
  EXPECT_TRUE(parse_rpe_delta(text, result)) << text;
  return result;
}

TEST(RpeDelta, ParsesFramesSecondsAndMetresOnly) {
  EXPECT_EQ(delta("10f").amount, 10);
  EXPECT_EQ(delta("0.5s").unit, RpeDelta::Unit::kSeconds);
  EXPECT_EQ(delta("2m").unit, RpeDelta::Unit::kMetres);
  RpeDelta d;
  for (const char* wrong : {"", "f", "1", "0s", "-1s", "1.5f", "nans", "1x", "1 s", "1e99m"})
    EXPECT_FALSE(parse_rpe_delta(wrong, d)) << wrong;
}

TEST(RelativeError, ScaleErrorGrowsWithTheDelta) {
  const PairedPoses poses = straight_trajectory(61, 1.1, 0);
  const RpeResult frame = relative_pose_error(poses, delta("1f"));
  EXPECT_EQ(frame.estimate.translation_m.count, 60u);
  EXPECT_NEAR(frame.estimate.translation_m.rmse, 0.001, 1e-12);
  EXPECT_NEAR(frame.identity.translation_m.rmse, 0.01, 1e-12);
  const RpeResult second = relative_pose_error(poses, delta("1s"));
  EXPECT_EQ(second.estimate.translation_m.count, 32u);  // 31 whole seconds, and one that is 33 ms short
  EXPECT_NEAR(second.estimate.translation_m.median, 0.03, 1e-12);
  const RpeResult metre = relative_pose_error(poses, delta("0.2m"));
  EXPECT_NEAR(metre.estimate.translation_m.mean, 0.02, 1e-3);
}

TEST(RelativeError, RotationIsInDegrees) {
  const RpeResult r = relative_pose_error(straight_trajectory(31, 1, 0.5), delta("10f"));
  EXPECT_NEAR(r.estimate.rotation_deg.rmse, 5, 1e-9);
  EXPECT_NEAR(r.identity.rotation_deg.rmse, 0, 1e-9);
}

TEST(RelativeError, PerfectEstimateInAnotherWorldHasNoError) {
  PairedPoses poses = straight_trajectory(40, 1, 0);
  for (Se3& T : poses.estimate) T = Se3{rotation_exp(Vector3(1, 2, 0.5)), Vector3(3, 4, 5)} * T;
  EXPECT_LT(relative_pose_error(poses, delta("1s")).estimate.translation_m.max, 1e-12);
  EXPECT_LT(end_drift(poses).translation_m, 1e-12);
}

TEST(EndDrift, IsTheEndToEndError) {
  const PairedPoses poses = straight_trajectory(101, 1.1, 0);
  EXPECT_NEAR(end_drift(poses).translation_m, 0.1, 1e-9);
  EXPECT_NEAR(identity_end_drift(poses).translation_m, 1.0, 1e-9);
}

TEST(DistanceErrors, ScaleErrorIsAConstantPercentage) {
  const std::vector<DistanceError> errors = distance_errors(straight_trajectory(121, 1.1, 0));
  ASSERT_EQ(errors.size(), 4u);  // 0.1, 0.2, 0.5 and 1 m of a path of 1.2 m
  EXPECT_EQ(errors[3].length_m, 1.0);
  for (const DistanceError& e : errors) EXPECT_NEAR(e.translation_percent.median, 10, 1.0) << e.length_m;
}

TEST(Evaluate, FindsLostIntervalsAndGaps) {
  Trajectory truth, estimate;
  for (int i = 0; i < 300; ++i) {
    const Se3 T{Matrix3::Identity(), Vector3(0.01 * i, std::sin(0.1 * i), 0)};
    if (i < 100 || i >= 150) truth.poses.push_back({i * 10'000'000LL, T});
    if (i % 3 == 0 && (i < 210 || i >= 240)) estimate.poses.push_back({i * 10'000'000LL, T});
  }
  Evaluation e;
  ASSERT_TRUE(evaluate(truth, estimate, {}, {}, {}, e).ok());
  ASSERT_EQ(e.lost.size(), 1u);
  EXPECT_EQ(e.lost[0].begin_ns, 2'070'000'000);
  EXPECT_EQ(e.lost[0].end_ns, 2'400'000'000);
  ASSERT_EQ(e.without_truth.size(), 1u);
  EXPECT_EQ(e.without_truth[0].begin_ns, 1'020'000'000);
  EXPECT_EQ(e.without_truth[0].end_ns, 1'470'000'000);
  EXPECT_LT(e.ate.position_m.max, 1e-12);
}

TEST(Evaluate, RefusesFilesWithoutCommonStamps) {
  Trajectory truth, estimate;
  truth.poses.push_back({0, {}});
  estimate.poses.push_back({1'000'000'000, {}});
  Evaluation e;
  const Status status = evaluate(truth, estimate, {}, {}, {}, e);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(std::string(status.message()).find("only 0 of 1 poses have ground truth"), std::string::npos);
}

}  // namespace
}  // namespace plvo::eval
