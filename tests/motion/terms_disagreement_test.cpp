// SPDX-License-Identifier: Apache-2.0
// Cochran's Q of points and lines, compared with its definition: the distance between the motion that points
// alone show and the one that lines alone show.
#include <gtest/gtest.h>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Bench;
using test::Gaussian;
using test::SimulatedPair;
using test::Solution;

constexpr int kPoints = 60, kLines = 25;

// Loads every match of a pair; all are inliers.
struct AllMatches {
  explicit AllMatches(const SimulatedPair& simulated) : pair(simulated) {
    bench.load(pair);
    for (ConstraintSet* set : bench.sets) test::flag_all(*set);
  }
  Solution solve(std::span<ConstraintSet* const> sets) const {
    return test::settle(CostTerms(sets), MotionReferences{}, RobustLoss::kNone, pair.truth);
  }
  double disagreement(std::span<ConstraintSet* const> sets) const {
    const CostTerms terms(sets);
    MotionProblem problem(terms, MotionReferences{}, {},
                          MotionProblem::make_kernels(terms, RobustLoss::kNone), solve(sets).T);
    Matrix6 H;
    Vector6 g;
    (void)problem.linearize(Vector6::Zero(), H, g);
    problem.accept();
    return problem.disagreement();
  }
  // dᵀ (C_P + C_L)⁻¹ d with d = ξ_P ⊟ ξ_L.
  double distance() const {
    const std::span<ConstraintSet* const> sets = bench.sets;
    const Solution points = solve(sets.first(1)), lines = solve(sets.last(1));
    const Vector6 d = boxminus(points.T, lines.T);
    const Matrix6 C = test::inverse(points.H) + test::inverse(lines.H);
    return d.dot(Vector6(test::solve_positive(C, d)));
  }

  SimulatedPair pair;
  Bench bench;
};

TEST(TermsDisagreement, IsTheDistanceBetweenPointsAndLines) {
  Gaussian gaussian(41);
  const int trials = 100;
  double mean = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const AllMatches matches(test::simulate(gaussian, kPoints, kLines));
    const double q = matches.disagreement(matches.bench.sets);
    EXPECT_NEAR(q, matches.distance(), 0.1 * q + 0.1) << trial;
    mean += q / trials;
  }
  // χ²(6) has the variance 12.
  EXPECT_NEAR(mean, 6, 3 * std::sqrt(12.0 / trials));
}

TEST(TermsDisagreement, IsLargeIfLinesMoveOtherwise) {
  Gaussian gaussian(42);
  for (int trial = 0; trial < 20; ++trial) {
    SimulatedPair pair = test::simulate(gaussian, kPoints, 0);
    pair.truth = boxplus(pair.truth, Vector6(0.01, 0, 0, 0, 0, 0));
    for (int i = 0; i < kLines; ++i) pair.add_random_line(gaussian);
    const AllMatches matches(pair);
    const double q = matches.disagreement(matches.bench.sets);
    EXPECT_GT(q, 16.8) << trial;  // 99 % of χ²(6)
    EXPECT_NEAR(q, matches.distance(), 0.1 * q + 0.1) << trial;
  }
}

TEST(TermsDisagreement, IsZeroOfOneKind) {
  Gaussian gaussian(43);
  const AllMatches matches(test::simulate(gaussian, kPoints, kLines));
  const std::span<ConstraintSet* const> sets = matches.bench.sets;
  EXPECT_NEAR(matches.disagreement(sets.first(1)), 0, 1e-6);
  EXPECT_NEAR(matches.disagreement(sets.last(1)), 0, 1e-6);
}

// What the odometry gets.
TEST(TermsDisagreement, IsPartOfTheEstimate) {
  Gaussian gaussian(44);
  Bench bench;
  const SimulatedPair pair = test::simulate(gaussian, kPoints, kLines);
  const MotionEstimate estimate = bench.estimate(pair);
  ASSERT_EQ(estimate.status, StatusCode::kOk);
  EXPECT_GT(estimate.disagreement, 0);
  EXPECT_LT(estimate.disagreement, 30);
}

}  // namespace
}  // namespace plvo
