// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/consistency.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "normal.hpp"
#include "plvo/base/random.hpp"

namespace plvo::eval {
namespace {

using test::normal;

// Draws the errors of motions from `sigma`, while `claimed` is the reported standard deviation.
Consistency monte_carlo(double sigma, double claimed) {
  Random random(3);
  Trajectory truth;
  std::vector<UncertainMotion> motions;
  for (int i = 0; i < 600; ++i) {
    truth.poses.push_back(
        {i * 30'000'000LL, {rotation_exp(Vector3(0, 0.01 * i, 0)), Vector3(0.02 * i, 0, 0)}});
    if (i == 0) continue;
    const Se3 motion = truth.poses[static_cast<std::size_t>(i)].T_world_camera.inverse() *
                       truth.poses[static_cast<std::size_t>(i - 1)].T_world_camera;
    Vector6 error;
    for (int k = 0; k < 6; ++k) error[k] = sigma * normal(random);
    motions.push_back({i * 30'000'000LL, (i - 1) * 30'000'000LL, boxplus(motion, error),
                       Matrix6::Identity() * (claimed * claimed)});
  }
  return motion_consistency(motions, truth, {.max_difference_ns = 1}, {});
}

TEST(Consistency, TrueCovarianceLiesInTheBand) {
  const Consistency c = monte_carlo(1e-3, 1e-3);
  EXPECT_EQ(c.count, 599u);
  EXPECT_EQ(c.independent, 599u);
  for (const Nees& nees : {c.all, c.translation, c.rotation}) {
    EXPECT_GT(nees.mean, nees.mean_band.low);
    EXPECT_LT(nees.mean, nees.mean_band.high);
    EXPECT_NEAR(nees.mean, nees.dof, 0.1 * nees.dof);
    EXPECT_GT(nees.median, nees.median_band.low);
    EXPECT_LT(nees.median, nees.median_band.high);
    EXPECT_NEAR(nees.inside_95, 0.95, 0.03);
  }
}

TEST(Consistency, OverconfidenceIsDetected) {
  const Consistency c = monte_carlo(2e-3, 1e-3);
  EXPECT_NEAR(c.all.mean, 24, 2);
  EXPECT_GT(c.all.mean, c.all.mean_band.high);
  EXPECT_GT(c.all.median, c.all.median_band.high);
  EXPECT_LT(c.all.inside_95, 0.6);
}

TEST(Consistency, SingularCovariancesAreCountedNotUsed) {
  PairedPoses poses;
  std::vector<StampedCovariance> covariances;
  for (int i = 0; i < 3; ++i) {
    poses.stamps_ns.push_back(i);
    poses.truth.push_back({});
    poses.estimate.push_back({});
    covariances.push_back({i, Matrix6::Zero()});
  }
  covariances[2].covariance = Matrix6::Identity();
  const Consistency c = pose_consistency(poses, covariances, {});
  EXPECT_EQ(c.count, 1u);
  EXPECT_EQ(c.singular, 1u);
}

// Values from published tables: χ²(6) and χ²(3) for one sample; χ²(120) and χ²(60) for 20 samples.
TEST(Consistency, BandOfTheMeanIsThatOfTheTables) {
  PairedPoses poses;
  std::vector<StampedCovariance> covariances;
  const auto bands_of = [&](int samples) {
    for (int i = static_cast<int>(poses.truth.size()); i <= samples; ++i) {
      poses.stamps_ns.push_back(i);
      poses.truth.push_back({});
      poses.estimate.push_back({});
      covariances.push_back({i, Matrix6::Identity()});
    }
    return pose_consistency(poses, covariances, {});
  };
  const auto expect = [](const Nees& nees, double low, double high) {
    EXPECT_NEAR(nees.mean_band.low, low, 3e-4 * low);
    EXPECT_NEAR(nees.mean_band.high, high, 3e-4 * high);
  };
  const Consistency one = bands_of(1);
  expect(one.all, 1.2373, 14.4494);
  expect(one.translation, 0.2158, 9.3484);
  const Consistency twenty = bands_of(20);
  expect(twenty.all, 91.5726 / 20, 152.2114 / 20);
  expect(twenty.rotation, 40.4817 / 20, 83.2977 / 20);
}

TEST(Consistency, PoseErrorsStartAtZero) {
  PairedPoses poses;
  for (int i = 0; i < 3; ++i) {
    poses.stamps_ns.push_back(i);
    poses.truth.push_back({rotation_exp(Vector3(0, 0, 1)), Vector3(0.1 * i, 1, 0)});
    poses.estimate.push_back({});
  }
  const std::vector<PoseError> errors = pose_errors(poses, {});
  EXPECT_EQ(errors[0].error.norm(), 0);
  EXPECT_NEAR(errors[2].error.head<3>().norm(), 0.2, 1e-12);
  EXPECT_FALSE(errors[2].sigma.has_value());
}

}  // namespace
}  // namespace plvo::eval
