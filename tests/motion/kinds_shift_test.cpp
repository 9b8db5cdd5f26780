// SPDX-License-Identifier: Apache-2.0
// By how much the motion shifts if one kind of landmark decides, compared with a solution in which this kind
// weighs more.
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
  OfEachKind shifts(std::span<ConstraintSet* const> sets) const {
    const CostTerms terms(sets);
    return MotionProblem(terms, MotionReferences{}, {}, MotionProblem::make_kernels(terms, RobustLoss::kNone),
                         solve(sets).T)
        .shifts();
  }
  // The optimum with one kind weighed 1024 times as much, from that with all weighed alike.
  Vector6 shift(std::size_t favoured) const {
    const Se3 T = solve(bench.sets).T;
    bench.sets[favoured]->set_reference(0, 0, 1024);
    const Vector6 shift = boxminus(solve(bench.sets).T, T);
    bench.sets[favoured]->set_reference(0, 0);
    return shift;
  }

  SimulatedPair pair;
  Bench bench;
};

TEST(KindsShift, IsThatOfASolutionInWhichTheKindWeighsMore) {
  Gaussian gaussian(45);
  constexpr auto kPointsColumn = static_cast<int>(LandmarkKind::kPoints);
  constexpr auto kLinesColumn = static_cast<int>(LandmarkKind::kLines);
  for (int trial = 0; trial < 20; ++trial) {
    const AllMatches matches(test::simulate(gaussian, kPoints, kLines));
    const OfEachKind shifts = std::sqrt(2.0) * matches.shifts(matches.bench.sets);
    for (const int column : {kPointsColumn, kLinesColumn}) {
      const Vector6 shift = matches.shift(column == kPointsColumn ? 0 : 1);
      EXPECT_LT((shifts.col(column) - shift).norm(), 0.1 * shift.norm()) << trial << ", " << column;
    }
    EXPECT_EQ(shifts.col(static_cast<int>(LandmarkKind::kSurfaces)).norm(), 0) << trial;
  }
}

TEST(KindsShift, LeadsFromOneMotionToTheOther) {
  Gaussian gaussian(46);
  const Vector6 apart(0.01, 0, 0, 0, 0, 0);
  for (int trial = 0; trial < 20; ++trial) {
    SimulatedPair pair = test::simulate(gaussian, kPoints, 0);
    pair.truth = boxplus(pair.truth, apart);
    for (int i = 0; i < kLines; ++i) pair.add_random_line(gaussian);
    const AllMatches matches(pair);
    const OfEachKind shifts = std::sqrt(2.0) * matches.shifts(matches.bench.sets);
    const Vector6 found = shifts.col(static_cast<int>(LandmarkKind::kLines)) -
                          shifts.col(static_cast<int>(LandmarkKind::kPoints));
    EXPECT_LT((found - apart).head<3>().norm(), 0.5 * apart.norm()) << trial;
  }
}

TEST(KindsShift, IsZeroOfOneKind) {
  Gaussian gaussian(47);
  const AllMatches matches(test::simulate(gaussian, kPoints, kLines));
  const std::span<ConstraintSet* const> sets = matches.bench.sets;
  EXPECT_LT(matches.shifts(sets.first(1)).norm(), 1e-6);
  EXPECT_LT(matches.shifts(sets.last(1)).norm(), 1e-6);
}

// What the odometry gets.
TEST(KindsShift, IsPartOfTheEstimate) {
  Gaussian gaussian(44);
  Bench bench;
  const SimulatedPair pair = test::simulate(gaussian, kPoints, kLines);
  const MotionEstimate estimate = bench.estimate(pair);
  ASSERT_EQ(estimate.status, StatusCode::kOk);
  EXPECT_GT(estimate.shifts.norm(), 0);
  EXPECT_LT(estimate.shifts.norm(), 0.1);
}

}  // namespace
}  // namespace plvo
