// SPDX-License-Identifier: Apache-2.0
// The estimator as the odometry uses it: outliers, little evidence, bad input, determinism.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Bench;
using test::Gaussian;
using test::SimulatedPair;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void expect_finite(const MotionEstimate& estimate) {
  EXPECT_TRUE(estimate.T_current_reference.is_finite());
  EXPECT_TRUE(estimate.C_H.allFinite());
  for (const Matrix6& information : estimate.information) EXPECT_TRUE(information.allFinite());
  EXPECT_TRUE(std::isfinite(estimate.lm.initial_cost) && std::isfinite(estimate.lm.final_cost));
  EXPECT_TRUE(std::isfinite(estimate.ransac.score));
}

struct Case {
  int points, lines;
  double outliers;
};
class Outliers : public ::testing::TestWithParam<Case> {};

TEST_P(Outliers, AreFound) {
  const Case& c = GetParam();
  Gaussian gaussian(7);
  Bench bench;
  MotionOptions options;
  options.ransac.max_iterations = 500;
  for (int trial = 0; trial < 20; ++trial) {
    const SimulatedPair pair = test::simulate(gaussian, c.points, c.lines, c.outliers);
    const MotionEstimate estimate = bench.estimate(pair, options, static_cast<std::uint64_t>(trial));
    ASSERT_EQ(estimate.status, StatusCode::kOk) << "trial " << trial;
    expect_finite(estimate);
    // χ²(6) exceeds 30 once in 25 000.
    EXPECT_LT(test::nees(estimate.T_current_reference, pair.truth, estimate.C_H.inverse()), 30)
        << "trial " << trial;
    const double good = (1 - c.outliers) * (c.points + c.lines);
    const int inliers = estimate.inliers[0] + estimate.inliers[1];
    EXPECT_GT(inliers, 0.85 * good);
    EXPECT_LT(inliers, good + 0.05 * (c.points + c.lines) + 2);
  }
}
INSTANTIATE_TEST_SUITE_P(Shares, Outliers,
                         ::testing::Values(Case{100, 0, 0.3}, Case{100, 0, 0.5}, Case{100, 0, 0.7},
                                           Case{0, 40, 0.3}, Case{0, 40, 0.5}, Case{0, 40, 0.7},
                                           Case{60, 20, 0.3}, Case{60, 20, 0.5}, Case{60, 20, 0.7}));

TEST(Estimator, NothingToWorkWith) {
  Bench bench;
  const SimulatedPair pair;
  const MotionEstimate estimate = bench.estimate(pair);
  EXPECT_EQ(estimate.status, StatusCode::kTooFewFeatures);
  expect_finite(estimate);
}

TEST(Estimator, SameSeedSameBits) {
  Gaussian gaussian(11);
  const SimulatedPair pair = test::simulate(gaussian, 200, 40, 0.4);
  Bench first, second(2 << 20);
  const MotionEstimate a = first.estimate(pair, {}, 42);
  const MotionEstimate b = second.estimate(pair, {}, 42);
  EXPECT_EQ(0, std::memcmp(&a.T_current_reference, &b.T_current_reference, sizeof(Se3)));
  EXPECT_EQ(0, std::memcmp(&a.C_H, &b.C_H, sizeof(Matrix6)));
  EXPECT_EQ(a.ransac.draws, b.ransac.draws);
}

TEST(Estimator, NaNsAreLeftOut) {
  Gaussian gaussian(12);
  SimulatedPair pair = test::simulate(gaussian, 60, 20);
  pair.points_reference[3].p.x() = kNaN;
  pair.points_current[4].Sigma(1, 1) = kNaN;
  pair.points_current[5].Sigma *= -1;
  pair.lines_reference[2].a.y() = kNaN;
  pair.lines_current[3].Sigma(5, 5) = std::numeric_limits<double>::infinity();
  pair.lines_current[4].b = pair.lines_current[4].a;
  Bench bench;
  const MotionEstimate estimate = bench.estimate(pair);
  ASSERT_EQ(estimate.status, StatusCode::kOk);
  expect_finite(estimate);
  EXPECT_EQ(estimate.usable[0], 57);
  EXPECT_EQ(estimate.usable[1], 17);
  for (int i : {3, 4, 5}) EXPECT_EQ(bench.points[0].inliers()[static_cast<std::size_t>(i)], 0);
}

}  // namespace
}  // namespace plvo
