// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/truth_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "normal.hpp"
#include "plvo/base/random.hpp"

namespace plvo::eval {
namespace {

using test::normal;

constexpr int kPoses = 4000;
constexpr TruthSigma kTruth = {0.002, 0.003};

// True poses at least a metre apart, so that an orientation error also changes the translation.
Se3 exact_pose(int i) {
  return {rotation_exp(Vector3(0.3 * std::sin(0.1 * i), 0.01 * i, 0.2)),
          Vector3(1.5 * i, std::sin(0.3 * i), 0)};
}

Vector3 draw(Random& random, double sigma) {
  Vector3 v;
  for (int k = 0; k < 3; ++k) v[k] = sigma * normal(random);
  return v;
}

// The true poses with the noise of a motion capture.
Trajectory measured_truth(Random& random) {
  Trajectory truth;
  for (int i = 0; i < kPoses; ++i) {
    const Se3 pose = exact_pose(i);
    truth.poses.push_back({i * 33'000'000LL,
                           {pose.R * rotation_exp(draw(random, kTruth.orientation_rad)),
                            pose.t + draw(random, kTruth.position_m)}});
  }
  return truth;
}

// Poses with errors that accumulate, as those of an odometry.
Trajectory estimate(Random& random, double sigma_m, double sigma_rad) {
  Trajectory result;
  Se3 pose;
  for (int i = 0; i < kPoses; ++i) {
    if (i > 0) {
      Se3 motion = exact_pose(i - 1).inverse() * exact_pose(i);
      motion.t += draw(random, sigma_m);
      motion.R = motion.R * rotation_exp(draw(random, sigma_rad));
      pose = pose * motion;
    }
    if (i % 7 != 3) result.poses.push_back({i * 33'000'000LL, pose});
  }
  return result;
}

TEST(TruthNoise, IsTheCommonErrorOfIndependentEstimates) {
  Random random(5);
  Trajectory truth = measured_truth(random);
  const Trajectory first = estimate(random, 0.001, 0.001), second = estimate(random, 0.004, 0.002);
  const TruthNoise noise = truth_noise(truth, first, second, {});
  EXPECT_GT(noise.motions, 3000u);
  EXPECT_NEAR(noise.sigma.orientation_rad, kTruth.orientation_rad, 0.05 * kTruth.orientation_rad);
  EXPECT_GT(noise.second_rad, noise.first_rad);
  EXPECT_NEAR(noise.first_rad, std::sqrt(3 * (2 * 9e-6 + 1e-6)), 0.05 * noise.first_rad);
}

TEST(TruthNoise, IsZeroForAnExactTruth) {
  Random random(6);
  Trajectory truth;
  for (int i = 0; i < kPoses; ++i) truth.poses.push_back({i * 33'000'000LL, exact_pose(i)});
  const TruthNoise noise =
      truth_noise(truth, estimate(random, 0.002, 0.002), estimate(random, 0.002, 0.002), {});
  EXPECT_LT(noise.sigma.position_m, 0.0003);
  EXPECT_LT(noise.sigma.orientation_rad, 0.0003);
  EXPECT_GT(noise.first_m, 0.002 * std::sqrt(3.0));
}

TEST(TruthNoise, WithoutCommonStampsThereIsNoMotion) {
  Random random(7);
  Trajectory late = estimate(random, 0.001, 0.001);
  const Trajectory first = late;
  for (StampedPose& pose : late.poses) pose.stamp_ns += 1000;
  EXPECT_EQ(truth_noise(measured_truth(random), first, late, {}).motions, 0u);
}

// Correct motions, compared with a noisy truth: the NEES is six once the noise is in the covariance.
TEST(TruthSigma, GivesTheExpectedNees) {
  Random random(8);
  const Trajectory truth = measured_truth(random);
  std::vector<UncertainMotion> motions;
  const double sigma = 1e-3;
  for (int i = 1; i < kPoses; i += 2) {
    Vector6 error;
    for (int k = 0; k < 6; ++k) error[k] = sigma * normal(random);
    motions.push_back({i * 33'000'000LL, (i - 1) * 33'000'000LL,
                       boxplus(exact_pose(i).inverse() * exact_pose(i - 1), error),
                       Matrix6::Identity() * (sigma * sigma)});
  }
  EXPECT_GT(motion_consistency(motions, truth, {}, {}).all.mean, 30);
  const Consistency c = motion_consistency(motions, truth, {}, kTruth);
  for (const Nees& nees : {c.all, c.translation, c.rotation}) {
    EXPECT_GT(nees.mean, nees.mean_band.low);
    EXPECT_LT(nees.mean, nees.mean_band.high);
  }
}

}  // namespace
}  // namespace plvo::eval
