// SPDX-License-Identifier: Apache-2.0
// Does the covariance tell the truth? Over many simulated pairs the normalised estimation error squared
// (NEES) of the 6-vector must average 6, within the 95 % band of its own χ² distribution; and the scatter of
// repeated trials must be C_H.
#include <gtest/gtest.h>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Bench;
using test::Gaussian;
using test::SimulatedPair;

// The sum of k independent χ²(6) is χ²(6k), close to normal for k ≥ 500: mean 6k, variance 12k.
::testing::AssertionResult inside_band(double mean, int trials) {
  const double half = 1.96 * std::sqrt(12.0 / trials);
  if (std::abs(mean - 6) <= half) return ::testing::AssertionSuccess() << mean;
  return ::testing::AssertionFailure() << "mean NEES " << mean << " is outside 6 ± " << half;
}

double mean_nees(int n, int m, std::uint64_t seed, int trials, RobustLoss loss = RobustLoss::kNone) {
  Gaussian gaussian(seed);
  Bench bench;
  double sum = 0;
  for (int k = 0; k < trials; ++k) {
    const SimulatedPair pair = test::simulate(gaussian, n, m);
    Se3 T;
    Matrix6 H;
    EXPECT_TRUE(converged(test::refine_all(bench, pair, Se3{}, loss, T, H).status));
    sum += test::nees(T, pair.truth, H);
  }
  return sum / trials;
}

TEST(MonteCarlo, NeesOfPointsIsInsideItsBand) { EXPECT_TRUE(inside_band(mean_nees(60, 0, 1, 800), 800)); }
TEST(MonteCarlo, NeesOfLinesIsInsideItsBand) { EXPECT_TRUE(inside_band(mean_nees(0, 25, 2, 800), 800)); }
TEST(MonteCarlo, NeesOfBothIsInsideItsBand) { EXPECT_TRUE(inside_band(mean_nees(40, 15, 3, 800), 800)); }
TEST(MonteCarlo, NeesIsInsideItsBandUnderTheDefaultRobustLoss) {
  EXPECT_TRUE(inside_band(mean_nees(40, 15, 4, 800, RobustLoss::kHuber), 800));
}

// The whole way, RANSAC and its χ² gate included, with outliers among the matches.
TEST(MonteCarlo, NeesIsInsideItsBandWhenMatchesHaveOutliers) {
  constexpr int kTrials = 600;
  Gaussian gaussian(5);
  Bench bench;
  double sum = 0;
  for (int k = 0; k < kTrials; ++k) {
    const SimulatedPair pair = test::simulate(gaussian, 80, 20, 0.3);
    const MotionEstimate estimate = bench.estimate(pair, {}, static_cast<std::uint64_t>(k));
    ASSERT_EQ(estimate.status, StatusCode::kOk);
    sum += test::nees(estimate.T_current_reference, pair.truth, test::inverse(estimate.C_H));
  }
  EXPECT_TRUE(inside_band(sum / kTrials, kTrials));
}

// One scene measured 1000 times: the sample covariance of ξ against C_H, entry by entry in units of C_H's own
// SDs.
void compare_scatter(int n, int m, std::uint64_t seed) {
  constexpr int kTrials = 1000;
  Gaussian gaussian(seed);
  gaussian.set_silent(true);
  const SimulatedPair scene = test::simulate(gaussian, n, m);
  gaussian.set_silent(false);
  Bench bench;
  Matrix6 scatter = Matrix6::Zero();
  Matrix6 stated = Matrix6::Zero();
  for (int k = 0; k < kTrials; ++k) {
    SimulatedPair pair = scene;
    for (Point3d& point : pair.points_reference) point.p += gaussian.draw<3>(point.Sigma);
    for (Point3d& point : pair.points_current) point.p += gaussian.draw<3>(point.Sigma);
    for (auto* lines : {&pair.lines_reference, &pair.lines_current})
      for (Line3d& line : *lines) {
        const Vector6 noise = gaussian.draw<6>(line.Sigma);
        line.a += noise.head<3>();
        line.b += noise.tail<3>();
      }
    Se3 T;
    Matrix6 H;
    (void)test::refine_all(bench, pair, scene.truth, RobustLoss::kNone, T, H);
    const Vector6 error = boxminus(T, scene.truth);
    scatter += error * error.transpose() / kTrials;
    stated += test::inverse(H) / kTrials;
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const double unit = std::sqrt(stated(i, i) * stated(j, j));
      // SD of a sample covariance entry: at most √(2/1000) = 0.045; four of them.
      EXPECT_NEAR(scatter(i, j) / unit, stated(i, j) / unit, 0.18) << i << ' ' << j;
    }
}

TEST(MonteCarlo, ScatterOfPointsMatchesTheCovariance) { compare_scatter(50, 0, 21); }
TEST(MonteCarlo, ScatterOfLinesMatchesTheCovariance) { compare_scatter(0, 20, 22); }
TEST(MonteCarlo, ScatterOfBothMatchesTheCovariance) { compare_scatter(30, 12, 23); }

}  // namespace
}  // namespace plvo
