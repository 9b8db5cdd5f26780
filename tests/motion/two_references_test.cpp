// SPDX-License-Identifier: Apache-2.0
// Matches with two references in one estimate, against the same matches carried to one reference by hand; and
// matches with correlated residuals, against a dense covariance.
#include "two_references.hpp"

#include <gtest/gtest.h>

#include "plvo/math/symmetric_eigen.hpp"

namespace plvo {
namespace {

using test::difference;
using test::Gaussian;
using test::kAway;
using test::Linearization;
using test::linearize;
using test::SimulatedPair;
using test::Solution;
using test::solve;
using test::TwoReferences;

TEST(TwoReferences, WithAnExactPoseAreOneProblem) {
  // Points are eliminated exactly wherever T is; the landmarks of lines settle to second order in the
  // noise, near the truth.
  struct Case {
    int points, lines;
    double away, tolerance;
  };
  for (const Case& c : {Case{40, 0, 1, 1e-10}, Case{20, 15, 0, 5e-4}})
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      TwoReferences two(seed, c.points, c.lines);
      TwoReferences one(seed, c.points, c.lines);
      const SimulatedPair carried = one.carried_to_base();
      const auto sets_two = two.sets_of(two.pairs[0], two.pairs[1], 1);
      const auto sets_one = one.sets_of(one.pairs[0], carried, 0);
      const Se3 T = boxplus(two.truth, Vector6(c.away * kAway));
      const Linearization a = linearize(sets_two, two.references, T);
      const Linearization b = linearize(sets_one, MotionReferences{}, T);
      EXPECT_NEAR(a.cost, b.cost, c.tolerance * b.cost);
      EXPECT_LT(difference(a.H, b.H), c.tolerance);
      EXPECT_LT(difference(a.g, b.g, b.H), 10 * c.tolerance * difference(b.g, Vector6::Zero(), b.H));
    }
}

// Every second match of the pair, from the match with this index on.
SimulatedPair half_of(const SimulatedPair& pair, std::size_t first) {
  SimulatedPair half = pair;
  half.point_matches.clear();
  half.line_matches.clear();
  for (std::size_t i = first; i < pair.point_matches.size(); i += 2)
    half.point_matches.push_back(pair.point_matches[i]);
  for (std::size_t i = first; i < pair.line_matches.size(); i += 2)
    half.line_matches.push_back(pair.line_matches[i]);
  return half;
}

TEST(ThreeReferences, TwoReferencesWithOnePoseEqualOne) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    // Points alone: their information does not depend on where landmarks have settled.
    TwoReferences two(seed, 40, 0);
    TwoReferences three(seed, 40, 0);
    const SimulatedPair even = half_of(three.pairs[1], 0), odd = half_of(three.pairs[1], 1);
    three.references[2].T_reference_base = three.T_1_0;
    const auto sets_two = two.sets_of(two.pairs[0], two.pairs[1], 1);
    const auto sets_three =
        three.sets_of(std::array{TwoReferences::MatchedWith{three.pairs[0], 0},
                                 TwoReferences::MatchedWith{even, 1}, TwoReferences::MatchedWith{odd, 2}});
    const Se3 T = boxplus(two.truth, kAway);
    const Linearization a = linearize(sets_three, three.references, T);
    const Linearization b = linearize(sets_two, two.references, T);
    EXPECT_NEAR(a.cost, b.cost, 1e-10 * b.cost);
    EXPECT_LT(difference(a.H, b.H), 1e-10);
    EXPECT_LT(difference(a.g, b.g, b.H), 1e-9 * difference(b.g, Vector6::Zero(), b.H));

    // Their poses err independently, and each half has its own: more is known than where one error moves all.
    two.references[1].covariance = three.references[1].covariance = three.references[2].covariance =
        1e-6 * Matrix6::Identity();
    const Linearization apart = linearize(sets_three, three.references, T);
    const Linearization together = linearize(sets_two, two.references, T);
    const Matrix6 more = apart.H - together.H;
    EXPECT_GT(symmetric_eigen<6>(more).values.minCoeff(), -1e-9 * more.trace());
    EXPECT_GT(more.trace(), 0.01 * together.H.trace());
    const MotionEstimate estimate =
        estimate_motion(sets_three, {}, three.references, {}, {}, 5, nullptr, three.arena);
    ASSERT_EQ(estimate.status, StatusCode::kOk);
    const Vector6 error = boxminus(estimate.T_current_reference, three.truth);
    EXPECT_LT(error.dot(Vector6(test::solve_positive(estimate.C_H, error))), 30);  // 6 in the mean
  }
}

TEST(TwoReferences, WithAnExactPoseGiveTheEstimateOfOne) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    TwoReferences two(seed, 30, 10);
    TwoReferences one(seed, 30, 10);
    const SimulatedPair carried = one.carried_to_base();
    const auto sets_two = two.sets_of(two.pairs[0], two.pairs[1], 1);
    const auto sets_one = one.sets_of(one.pairs[0], carried, 0);
    const Se3 start = boxplus(two.truth, kAway);
    const Solution x = solve(sets_two, two.references, start);
    const Solution y = solve(sets_one, MotionReferences{}, start);
    ASSERT_TRUE(converged(x.summary.status));
    ASSERT_TRUE(converged(y.summary.status));
    // As near as the lines' landmarks are settled: to second order in the noise.
    EXPECT_LT(boxminus(x.T, y.T).cwiseAbs().maxCoeff(), 5e-6);
    EXPECT_LT(difference(x.H, y.H), 1e-2);

    // And so in the whole estimator, consensus included.
    const MotionEstimate p = estimate_motion(sets_two, {}, two.references, {}, {}, 5, nullptr, two.arena);
    const MotionEstimate q = estimate_motion(sets_one, {}, MotionReferences{}, {}, {}, 5, nullptr, one.arena);
    ASSERT_EQ(p.status, StatusCode::kOk);
    ASSERT_EQ(q.status, StatusCode::kOk);
    EXPECT_EQ(p.inliers, q.inliers);
    EXPECT_LT(boxminus(p.T_current_reference, q.T_current_reference).cwiseAbs().maxCoeff(), 5e-6);
  }
}

TEST(TwoReferences, ExactAndUnknownPosesAreTheLimits) {
  TwoReferences two(7, 30, 10);
  const auto sets = two.sets_of(two.pairs[0], two.pairs[1], 1);
  const std::span<ConstraintSet* const> first(sets.data(), 2);
  const Se3 start = boxplus(two.truth, kAway);

  two.references[1].covariance.setZero();
  const Solution exact = solve(sets, two.references, start);
  two.references[1].covariance = 1e-14 * Matrix6::Identity();
  const Solution nearly_exact = solve(sets, two.references, start);
  EXPECT_LT(difference(nearly_exact.H, exact.H), 1e-5);
  EXPECT_LT(boxminus(nearly_exact.T, exact.T).cwiseAbs().maxCoeff(), 1e-7);

  const Solution alone = solve(first, two.references, start);
  two.references[1].covariance = 1e4 * Matrix6::Identity();
  const Solution unknown = solve(sets, two.references, start);
  ASSERT_TRUE(converged(unknown.summary.status));
  EXPECT_LT(difference(unknown.H, alone.H), 1e-5);
  EXPECT_LT(boxminus(unknown.T, alone.T).cwiseAbs().maxCoeff(), 1e-7);
  // They are not the same to begin with.
  EXPECT_GT(difference(exact.H, alone.H), 0.3);
  EXPECT_GT(difference(exact.H, unknown.H), 0.3);
}

// A pose that is wrong by many of its SDs, with robust weights: the solution is a minimum of the cost over
// the motion and the pose together, and both come near the truth.
TEST(TwoReferences, EstimatesAReferencePoseThatIsFarOff) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    TwoReferences two(seed, 60, 0);
    const auto sets = two.sets_of(two.pairs[0], two.pairs[1], 1);
    const Vector6 sd = (Vector6() << 1e-3, 1e-3, 1e-3, 5e-4, 5e-4, 5e-4).finished();
    const Vector6 wrong = (Vector6() << 8, -6, 7, 8, -7, 6).finished();
    two.references[1].covariance = sd.cwiseAbs2().asDiagonal();
    two.references[1].T_reference_base = boxplus(two.T_1_0, sd.cwiseProduct(wrong));
    const CostTerms terms(sets);
    const auto kernels = MotionProblem::make_kernels(terms, RobustLoss::kHuber);
    MotionProblem problem(terms, two.references, {}, kernels, boxplus(two.truth, kAway));
    LevenbergMarquardt<6> solver;
    const LmSummary summary = solver.solve(problem, {});
    ASSERT_TRUE(converged(summary.status)) << static_cast<int>(summary.status);

    // The cost around the solution, as a function of the motion, and of the pose in units of its SDs.
    const MotionReference found = problem.poses()[1];
    const auto cost = [&](const Vector6& of_motion, const Vector6& of_pose) {
      MotionReferences exact;
      exact[1].T_reference_base = boxplus(found.T_reference_base, sd.cwiseProduct(of_pose));
      MotionProblem at(terms, exact, {}, kernels, boxplus(problem.T_current_reference(), of_motion));
      Matrix6 H;
      Vector6 g;
      return at.linearize(Vector6::Zero(), H, g) + 0.5 * (found.moved + of_pose).squaredNorm();
    };
    const double least = cost(Vector6::Zero(), Vector6::Zero());
    EXPECT_NEAR(least, summary.final_cost, 1e-6 * least);
    for (int k = 0; k < 6; ++k)
      for (const double side : {-1.0, 1.0}) {
        EXPECT_GT(cost(side * 3e-4 * Vector6::Unit(k), Vector6::Zero()), least);
        EXPECT_GT(cost(Vector6::Zero(), side * 0.3 * Vector6::Unit(k)), least);
      }
    const Vector6 left = boxminus(found.T_reference_base, two.T_1_0).cwiseQuotient(sd);
    EXPECT_LT(left.norm(), 0.75 * wrong.norm());
  }
}

// The pose and the nuisance parameters are eliminated together: for a given motion, both move as the solution
// of one dense system of both says.
TEST(TwoReferences, PosesAndNuisanceParametersEqualADenseSystem) {
  CameraModel camera;
  camera.readout_s = 0.03;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    TwoReferences two(seed, 40, 0);
    const auto sets = two.sets_of(two.pairs[0], two.pairs[1], 1);
    const Vector6 sd = (Vector6() << 2e-3, 1e-3, 3e-3, 1e-3, 5e-4, 2e-3).finished();
    two.references[1].covariance = sd.cwiseAbs2().asDiagonal();
    const NuisanceParameters shared(Exposure(camera, Vector6::Zero(), 0), 0.3, 0.004);
    const Se3 T = boxplus(two.truth, kAway);
    const CostTerms terms(sets);
    const auto kernels = MotionProblem::make_kernels(terms, RobustLoss::kNone);
    MotionProblem problem(terms, two.references, shared, kernels, T);
    Matrix6 H;
    Vector6 g;
    (void)problem.linearize(Vector6::Zero(), H, g);
    problem.accept();

    // T_current_reference about the pose in its SDs, numerically; the sets' own information of the rest.
    const Se3 T_1 = T * two.T_1_0.inverse();
    Eigen::MatrixXd J(6, 6);
    constexpr double kStep = 1e-3;
    for (int k = 0; k < 6; ++k) {
      const Se3 moved = T * boxplus(two.T_1_0, kStep * sd[k] * Vector6::Unit(k)).inverse();
      J.col(k) = boxminus(moved, T_1) / kStep;
    }
    JointInformation base, other;
    for (std::size_t kind = 0; kind < sets.size(); ++kind)
      (void)sets[kind]->linearize(kind < 2 ? T : T_1, shared, kernels[kind], kind < 2 ? base : other);
    constexpr int n = NuisanceParameters::kCount;
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(6 + n, 6 + n);
    dense.topLeftCorner(6, 6) =
        J.transpose() * Eigen::MatrixXd(other.H.topLeftCorner<6, 6>()) * J + Eigen::MatrixXd::Identity(6, 6);
    dense.topRightCorner(6, n) = J.transpose() * Eigen::MatrixXd(other.H.topRightCorner<6, n>());
    dense.bottomLeftCorner(n, 6) = dense.topRightCorner(6, n).transpose();
    dense.bottomRightCorner(n, n) =
        Eigen::MatrixXd(base.H.bottomRightCorner<n, n>() + other.H.bottomRightCorner<n, n>());
    for (int k = 0; k < n; ++k) dense(6 + k, 6 + k) += 1 / (shared.sigma(k) * shared.sigma(k));
    Eigen::VectorXd gradient(6 + n);
    gradient << J.transpose() * Eigen::VectorXd(other.g.head<6>()),
        Eigen::VectorXd(base.g.tail<n>() + other.g.tail<n>());
    const Eigen::VectorXd expected = -dense.inverse() * gradient;
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(problem.poses()[1].moved[k], expected[k], 1e-3);
    const NuisanceEstimate found = problem.shared(Matrix6::Zero());
    for (int k = 0; k < n; ++k) EXPECT_NEAR(found.value[k], expected[6 + k], 1e-3 * shared.sigma(k));
  }
}

TEST(CorrelatedResiduals, WeighAsADenseCovarianceSays) {
  // n numbers that share a part of their error tell of their common value 1ᵀ Σ⁻¹ 1.
  for (const int n : {1, 2, 7, 40})
    for (const double rho : {0.0, 0.005, 0.05, 0.5}) {
      const Eigen::MatrixXd Sigma =
          (1 - rho) * Eigen::MatrixXd::Identity(n, n) + rho * Eigen::MatrixXd::Ones(n, n);
      const double weight = test::solve_positive(Sigma, Eigen::VectorXd::Ones(n)).sum();
      // n times the same match, and as many more that are no inliers.
      Gaussian gaussian(11);
      SimulatedPair one;
      one.truth = test::random_motion(gaussian);
      one.add_point(gaussian, test::random_point(gaussian));
      one.add_random_line(gaussian);
      SimulatedPair many = one;
      for (int i = 1; i < 2 * n; ++i) {
        many.point_matches.push_back({0, 0});
        many.line_matches.push_back({0, 0});
      }
      test::Bench single, bench;
      single.load(one);
      bench.load(many);
      for (std::size_t kind = 0; kind < 2; ++kind) {
        ConstraintSet* const first[] = {single.sets[kind]};
        ConstraintSet* const all[] = {bench.sets[kind]};
        test::flag_all(*first[0]);
        for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) all[0]->inliers()[2 * i] = 1;
        for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) all[0]->inliers()[2 * i + 1] = 0;
        all[0]->set_reference(0, rho);
        const Se3 T = boxplus(one.truth, kAway);
        const Linearization a = linearize(first, MotionReferences{}, T);
        const Linearization b = linearize(all, MotionReferences{}, T);
        EXPECT_NEAR(b.cost, weight * a.cost, 1e-9 * b.cost) << n << " of kind " << kind << ", rho " << rho;
        const double scale = a.H.cwiseAbs().maxCoeff() * weight;
        EXPECT_LT((b.H - weight * a.H).cwiseAbs().maxCoeff(), 1e-9 * scale);
        EXPECT_LT((b.g - weight * a.g).cwiseAbs().maxCoeff(), 1e-9 * weight * a.g.cwiseAbs().maxCoeff());
      }
    }
}

}  // namespace
}  // namespace plvo
