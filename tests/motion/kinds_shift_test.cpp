// SPDX-License-Identifier: Apache-2.0
// By how much the motion shifts if one kind of landmark decides, compared with a solution in which this kind
// weighs more.
#include <gtest/gtest.h>

#include "plvo/math/chi_square.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Bench;
using test::Gaussian;
using test::SimulatedPair;

constexpr int kPoints = 60, kLines = 25;
constexpr int kPointsColumn = static_cast<int>(LandmarkKind::kPoints);
constexpr int kLinesColumn = static_cast<int>(LandmarkKind::kLines);

// The shifts of an estimate of two kinds, which divides them by √2.
OfEachKind undivided(const MotionEstimate& estimate) { return std::sqrt(2.0) * estimate.shifts; }

void judge(ConstraintSet& set, const Se3& T, double scale) {
  const double threshold = scale * chi_square_quantile(set.dof(), 0.99);
  for (std::size_t i = 0; i < set.size(); ++i)
    set.inliers()[i] = set.usable(i) && set.mahalanobis_squared(i, T, threshold) <= threshold ? 1 : 0;
}

// The slow version: the optimum of both kinds with one weighed 1024 times as much, whose matches are judged
// anew in each round. The other kind keeps the flags that the estimate left.
Vector6 shift_by_weight(Bench& bench, std::size_t favoured, const MotionEstimate& estimate) {
  ConstraintSet& set = *bench.sets[favoured];
  set.set_reference(0, 0, 1024);
  Se3 T = estimate.T_current_reference;
  for (const double scale : {400, 20, 1}) {
    judge(set, T, scale);
    T = test::settle(CostTerms(bench.sets), MotionReferences{}, RobustLoss::kHuber, T).T;
  }
  return boxminus(T, estimate.T_current_reference);
}

// Doubles the standard deviations, so that every match is an inlier with the full weight.
void double_sigmas(SimulatedPair& pair) {
  for (auto* points : {&pair.points_reference, &pair.points_current})
    for (Point3d& point : *points) point.Sigma *= 4;
  for (auto* lines : {&pair.lines_reference, &pair.lines_current})
    for (Line3d& line : *lines) line.Sigma *= 4;
}

TEST(KindsShift, IsThatOfASolutionInWhichTheKindWeighsMore) {
  Gaussian gaussian(45);
  for (int trial = 0; trial < 20; ++trial) {
    Bench bench;
    const SimulatedPair pair = test::simulate(gaussian, kPoints, kLines, 0.1);
    const MotionEstimate estimate = bench.estimate(pair);
    ASSERT_EQ(estimate.status, StatusCode::kOk);
    const OfEachKind shifts = undivided(estimate);
    std::vector<std::vector<std::uint8_t>> flags;
    for (const ConstraintSet* set : bench.sets)
      flags.emplace_back(set->inliers().begin(), set->inliers().end());
    for (const int column : {kPointsColumn, kLinesColumn}) {
      const std::size_t favoured = column == kPointsColumn ? 0 : 1;
      const Vector6 shift = shift_by_weight(bench, favoured, estimate);
      EXPECT_LT((shifts.col(column) - shift).norm(), 0.1 * shift.norm()) << trial << ", " << column;
      ConstraintSet& set = *bench.sets[favoured];
      set.set_reference(0, 0);
      std::copy(flags[favoured].begin(), flags[favoured].end(), set.inliers().begin());
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
    Bench bench;
    const OfEachKind shifts = undivided(bench.estimate(pair));
    const Vector6 found = shifts.col(kLinesColumn) - shifts.col(kPointsColumn);
    EXPECT_LT((found - apart).head<3>().norm(), 0.5 * apart.norm()) << trial;
  }
}

// The points decide, and most lines are outliers.
TEST(KindsShift, HearsAKindThatIsOutvoted) {
  Gaussian gaussian(48);
  const Vector6 apart(0.04, 0, 0, 0, 0, 0);
  for (int trial = 0; trial < 20; ++trial) {
    SimulatedPair pair = test::simulate(gaussian, 3 * kPoints, 0);
    pair.truth = boxplus(pair.truth, apart);
    for (int i = 0; i < kLines; ++i) pair.add_random_line(gaussian);
    Bench bench;
    const MotionEstimate estimate = bench.estimate(pair);
    ASSERT_LT(estimate.inliers[1], kLines / 2) << trial;
    const OfEachKind shifts = undivided(estimate);
    EXPECT_LT((shifts.col(kLinesColumn) - apart).head<3>().norm(), 0.3 * apart.norm()) << trial;
    EXPECT_LT(shifts.col(kPointsColumn).head<3>().norm(), 0.1 * apart.norm()) << trial;
  }
}

TEST(KindsShift, LeavesTheConsensusAsItWas) {
  Gaussian gaussian(49);
  Bench bench;
  const SimulatedPair pair = test::simulate(gaussian, kPoints, kLines, 0.3);
  const MotionEstimate estimate = bench.estimate(pair);
  MotionStart no_shifts = nullptr;
  no_shifts.find_shifts = false;
  Bench other;
  const MotionEstimate without = other.estimate(pair, {}, 1, no_shifts);
  ASSERT_EQ(estimate.status, StatusCode::kOk);
  ASSERT_GT(estimate.shifts.norm(), 0);
  ASSERT_EQ(without.shifts.norm(), 0);
  EXPECT_EQ(estimate.inliers, without.inliers);
  for (std::size_t s = 0; s < bench.sets.size(); ++s)
    EXPECT_TRUE(std::ranges::equal(bench.sets[s]->inliers(), other.sets[s]->inliers())) << s;
}

TEST(KindsShift, IsZeroOfOneKind) {
  Gaussian gaussian(47);
  for (const bool points : {true, false}) {
    SimulatedPair pair = test::simulate(gaussian, points ? kPoints : 0, points ? 0 : kLines);
    double_sigmas(pair);
    Bench bench;
    const MotionEstimate estimate = bench.estimate(pair);
    ASSERT_EQ(estimate.status, StatusCode::kOk);
    EXPECT_LT(estimate.shifts.norm(), 1e-6);
  }
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
