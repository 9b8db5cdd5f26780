// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/truth_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "normal.hpp"
#include "plvo/base/random.hpp"
#include "plvo/eval/evaluation.hpp"

namespace plvo::eval {
namespace {

using test::normal;

constexpr double kDegree = 0.017453292519943295;
const Vector3 kTurn = kDegree * Vector3(0.8, -0.6, 0.3);
constexpr double kClock_s = 0.012;

// A hand that rotates the camera about all axes at varying speed.
Se3 hand_pose(std::int64_t stamp_ns) {
  const double t = static_cast<double>(stamp_ns) * 1e-9;
  return {
      rotation_exp(Vector3(0.3 * std::sin(2.1 * t), 0.4 * std::sin(1.7 * t + 1), 0.3 * std::sin(2.9 * t))),
      Vector3(0.3 * std::sin(1.3 * t), 0.2 * std::sin(2.3 * t), 0.3 * std::cos(0.9 * t))};
}

// A motion capture at 100 Hz. Rotating its camera by `turn` and sampling it `clock_s` later gives the exact
// poses.
Trajectory turned_truth(const Vector3& turn, double clock_s, double seconds) {
  Trajectory truth;
  const std::int64_t clock_ns = std::llround(clock_s * 1e9);
  for (std::int64_t t = -200'000'000; t < std::llround(seconds * 1e9) + 200'000'000; t += 10'000'000) {
    const Se3 pose = hand_pose(t);
    truth.poses.push_back({t + clock_ns, {pose.R * rotation_exp(turn).transpose(), pose.t}});
  }
  return truth;
}

// Poses at 30 Hz whose errors accumulate from one to the next.
Trajectory hand_estimate(Random& random, double sigma_m, double sigma_rad, double seconds) {
  Trajectory result;
  Se3 pose;
  constexpr std::int64_t kPeriod_ns = 33'333'333;
  for (std::int64_t t = 0; t < std::llround(seconds * 1e9); t += kPeriod_ns) {
    if (t > 0) {
      const auto draw = [&random](double sigma) {
        return Vector3(sigma * normal(random), sigma * normal(random), sigma * normal(random));
      };
      Se3 motion = hand_pose(t - kPeriod_ns).inverse() * hand_pose(t);
      motion.t += draw(sigma_m);
      motion.R = motion.R * rotation_exp(draw(sigma_rad));
      pose = pose * motion;
    }
    result.poses.push_back({t, pose});
  }
  return result;
}

// Returns the error of a fit in standard deviations.
Vector4 normalised(const TruthFit& fit, const Vector3& turn, double clock_s) {
  Vector4 e;
  e << (fit.rotation_rad - turn).cwiseQuotient(fit.rotation_sigma_rad),
      (fit.clock_s - clock_s) / fit.clock_sigma_s;
  return e;
}

TEST(TruthFit, ErrorsMatchTheReportedStandardDeviations) {
  Random random(3);
  const Trajectory turned = turned_truth(kTurn, kClock_s, 20), straight = turned_truth({0, 0, 0}, 0, 20);
  double squares = 0;
  constexpr int kDraws = 20;
  for (int i = 0; i < kDraws; ++i) {
    const Trajectory est = hand_estimate(random, 0.0005, 0.0005, 20);
    for (const bool is_turned : {true, false}) {
      TruthFit fit;
      ASSERT_TRUE(fit_truth(is_turned ? turned : straight, est, 0, fit).ok());
      EXPECT_EQ(fit.independent, 20u);
      EXPECT_LT(fit.rotation_sigma_rad.maxCoeff(), 0.2 * kDegree);
      EXPECT_LT(fit.clock_sigma_s, 0.002);
      const Vector4 e = normalised(fit, is_turned ? kTurn : Vector3(0, 0, 0), is_turned ? kClock_s : 0);
      EXPECT_LT(e.cwiseAbs().maxCoeff(), 4.5);
      squares += e.squaredNorm() / (2 * 4 * kDraws);
    }
  }
  EXPECT_GT(squares, 0.5);
  EXPECT_LT(squares, 1.5);
}

TEST(TruthFit, UsesTheOffsetOfTheEstimate) {
  Random random(4);
  const Trajectory est = hand_estimate(random, 0.0005, 0.0005, 20);
  TruthFit fit;
  ASSERT_TRUE(fit_truth(turned_truth(kTurn, kClock_s, 20), est, 20'000'000, fit).ok());
  EXPECT_LT(std::abs(normalised(fit, kTurn, kClock_s - 0.02)[3]), 4);
}

TEST(TruthFit, CorrectedTruthIsExact) {
  Random random(5);
  EvaluationOptions options;
  options.fit_truth = true;
  Evaluation e;
  // The clock offset is a multiple of the truth's period, so that the interpolation errors are equal before
  // and after the fit.
  ASSERT_TRUE(
      evaluate(turned_truth(kTurn, 0.02, 20), hand_estimate(random, 0, 0, 20), {}, {}, options, e).ok());
  ASSERT_TRUE(e.truth_fit);
  EXPECT_LT((e.truth_fit->rotation_rad - kTurn).norm(), 1e-4);
  EXPECT_NEAR(e.truth_fit->clock_s, 0.02, 1e-4);
  EXPECT_GT(e.second_before_fit.rotation_deg.rmse, 0.3);
  ASSERT_EQ(e.rpe.size(), 2u);
  EXPECT_LT(e.rpe[1].estimate.rotation_deg.max, 0.005);
  EXPECT_LT(e.rpe[1].estimate.translation_m.max, 1e-4);
  EXPECT_LT(e.ate.position_m.max, 1e-4);
  EXPECT_EQ(e.poses.truth.size(), 601u);
}

void expect_refused(const Trajectory& truth, const Trajectory& est, const char* why) {
  TruthFit fit;
  const Status status = fit_truth(truth, est, 0, fit);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(std::string(status.message()).find(why), std::string::npos) << status.message();
}

TEST(TruthFit, RefusesUndeterminedFits) {
  Random random(6);
  const Trajectory truth = turned_truth(kTurn, kClock_s, 20);
  expect_refused(truth, hand_estimate(random, 0.001, 0.001, 1.5),
                 "1 motions over a second that do not overlap");
  expect_refused(turned_truth(kTurn, 0.3, 20), hand_estimate(random, 0.001, 0.001, 15),
                 "more than 0.1 s off; shift the estimate's stamps by --offset");
  Trajectory still = truth;
  for (StampedPose& pose : still.poses) pose.T_world_camera = {};
  expect_refused(still, hand_estimate(random, 0.001, 0.001, 20), "must turn about more than one axis");
}

}  // namespace
}  // namespace plvo::eval
