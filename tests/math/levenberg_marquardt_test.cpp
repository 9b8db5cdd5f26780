// SPDX-License-Identifier: Apache-2.0
#include "plvo/math/levenberg_marquardt.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "plvo/math/cholesky.hpp"

namespace plvo {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Rosenbrock's function as least squares, r = (10 (y − x²), 1 − x): a textbook case in which plain
// Gauss–Newton overshoots.
struct Rosenbrock {
  Vector2 x{-1.2, 1.0};
  Vector2 candidate;
  int calls = 0;

  double linearize(const Vector2& step, Matrix2& H, Vector2& g) {
    ++calls;
    candidate = x + step;
    const Vector2 r(10 * (candidate.y() - candidate.x() * candidate.x()), 1 - candidate.x());
    Matrix2 J;
    J << -20 * candidate.x(), 10, -1, 0;
    H = J.transpose() * J;
    g = J.transpose() * r;
    return 0.5 * r.squaredNorm();
  }
  void accept() { x = candidate; }
};

// ½ scale |x − centre|² in 3D, with one switch per failure.
struct Bowl {
  Vector3 x{1, 2, 3};
  Vector3 candidate;
  Vector3 centre = Vector3::Zero();
  double scale = 1;
  bool observes_z = true;
  double forbidden_radius = -1;  // the cost is NaN within this distance of the centre
  bool gradient_lies = false;    // points uphill
  bool negative_curvature = false;

  double linearize(const Vector3& step, Matrix3& H, Vector3& g) {
    candidate = x + step;
    Vector3 r = candidate - centre;
    if (!observes_z) r.z() = 0;
    H = scale * Matrix3::Identity();
    if (!observes_z) H(2, 2) = 0;
    if (negative_curvature) H = -H;
    g = (gradient_lies ? -scale : scale) * r;
    if (r.norm() < forbidden_radius) return kNaN;
    return 0.5 * scale * r.squaredNorm();
  }
  void accept() { x = candidate; }
};

TEST(LevenbergMarquardt, ConvergesOnRosenbrocksFunction) {
  Rosenbrock problem;
  LevenbergMarquardt<2> solver;
  LmOptions options;
  options.max_iterations = 50;
  const LmSummary summary = solver.solve(problem, options);
  EXPECT_TRUE(converged(summary.status));
  EXPECT_NEAR(problem.x.x(), 1, 1e-9);
  EXPECT_NEAR(problem.x.y(), 1, 1e-9);
  EXPECT_LT(summary.final_cost, 1e-18);
  EXPECT_DOUBLE_EQ(summary.initial_cost, 0.5 * (4.4 * 4.4 + 2.2 * 2.2));
  EXPECT_EQ(problem.calls, summary.iterations + 1)
      << "one pass over the residuals per iteration, and one to begin";
}

// Size-optimised code solves through LmAnyProblem.
TEST(LevenbergMarquardt, TypeErasedProblemHasTheSameSolution) {
  LmOptions options;
  options.max_iterations = 50;
  Rosenbrock known, forgotten;
  LevenbergMarquardt<2> of_known, of_any;
  LmAnyProblem<2> any(forgotten);
  const LmSummary expected = of_known.solve(known, options);
  const LmSummary summary = of_any.solve(any, options);
  EXPECT_EQ(summary.status, expected.status);
  EXPECT_EQ(summary.iterations, expected.iterations);
  EXPECT_EQ(forgotten.x, known.x);
  EXPECT_EQ(forgotten.calls, known.calls);
  EXPECT_EQ(of_any.hessian(), of_known.hessian());
}

TEST(LevenbergMarquardt, HessianAndGradientBelongToTheFinalState) {
  Rosenbrock problem;
  LevenbergMarquardt<2> solver;
  LmOptions options;
  options.max_iterations = 7;  // stop somewhere on the way
  (void)solver.solve(problem, options);
  Matrix2 H;
  Vector2 g;
  (void)problem.linearize(Vector2::Zero(), H, g);
  EXPECT_EQ(solver.hessian(), H);
  EXPECT_EQ(solver.gradient(), g);
}

TEST(LevenbergMarquardt, CostNeverRises) {
  double previous = std::numeric_limits<double>::infinity();
  for (int bound = 0; bound < 40; ++bound) {
    Rosenbrock problem;
    LevenbergMarquardt<2> solver;
    LmOptions options;
    options.max_iterations = bound;
    const LmSummary summary = solver.solve(problem, options);
    EXPECT_LE(summary.final_cost, previous);
    EXPECT_LE(summary.iterations, bound);
    EXPECT_LE(summary.accepted, summary.iterations);
    previous = summary.final_cost;
  }
}

TEST(LevenbergMarquardt, StopsAtTheGradientTolerance) {
  Bowl problem;
  problem.x = {3e-3, 0, 0};
  LevenbergMarquardt<3> solver;
  LmOptions options;
  options.gradient_tolerance = 3e-3;  // max |g_i| ≤ tolerance holds with equality
  LmSummary summary = solver.solve(problem, options);
  EXPECT_EQ(summary.status, LmStatus::kGradientTolerance);
  EXPECT_EQ(summary.iterations, 0);
  options.gradient_tolerance = 2.9e-3;
  summary = solver.solve(problem, options);
  EXPECT_GT(summary.iterations, 0);
}

TEST(LevenbergMarquardt, StopsAtTheStepTolerance) {
  Bowl problem;
  problem.x = {1e-3, 0, 0};
  problem.scale = 1e6;
  LevenbergMarquardt<3> solver;
  LmOptions options;
  options.gradient_tolerance = 0;
  options.step_tolerance = 1e-3;  // the undamped step is 1e-3 and damping only shortens it
  LmSummary summary = solver.solve(problem, options);
  EXPECT_EQ(summary.status, LmStatus::kStepTolerance);
  EXPECT_EQ(problem.x.x(), 1e-3) << "a step within the tolerance is not taken";
  options.step_tolerance = 0.9e-3;
  summary = solver.solve(problem, options);
  EXPECT_EQ(summary.accepted, 1);
}

TEST(LevenbergMarquardt, StopsAtTheDecreaseTolerance) {
  Bowl problem;  // H = I: the full step, of length k, lowers the cost by ½ k²
  problem.x = {0.1, 0, 0};
  LevenbergMarquardt<3> solver;
  LmOptions options;
  options.decrease_tolerance = 0.5 * 0.1 * 0.1;
  LmSummary summary = solver.solve(problem, options);
  EXPECT_EQ(summary.status, LmStatus::kDecreaseTolerance);
  EXPECT_EQ(summary.iterations, 0) << "a step that promises no more is not tried";
  EXPECT_EQ(problem.x.x(), 0.1);
  options.decrease_tolerance = 0.5 * 0.09 * 0.09;
  summary = solver.solve(problem, options);
  EXPECT_EQ(summary.accepted, 1);
  EXPECT_LT(problem.x.norm(), 1e-4);
}

TEST(LevenbergMarquardt, StopsAtTheIterationBound) {
  Rosenbrock problem;
  LevenbergMarquardt<2> solver;
  LmOptions options;
  options.max_iterations = 2;
  const LmSummary summary = solver.solve(problem, options);
  EXPECT_EQ(summary.status, LmStatus::kMaxIterations);
  EXPECT_EQ(summary.iterations, 2);
  EXPECT_FALSE(converged(summary.status));
}

TEST(LevenbergMarquardt, ReturnsNotFiniteAndKeepsTheStateWhenTheInitialCostIsNaN) {
  Bowl problem;
  problem.forbidden_radius = 100;
  LevenbergMarquardt<3> solver;
  EXPECT_EQ(solver.solve(problem).status, LmStatus::kNotFinite);
  EXPECT_EQ(problem.x, Vector3(1, 2, 3));
}

TEST(LevenbergMarquardt, RejectsAStepWhoseCostIsNaN) {
  Bowl problem;
  problem.forbidden_radius = 0.5;
  LevenbergMarquardt<3> solver;
  LmOptions options;
  options.max_iterations = 200;
  const LmSummary summary = solver.solve(problem, options);
  EXPECT_NE(summary.status, LmStatus::kNotFinite);
  EXPECT_TRUE(problem.x.allFinite());
  EXPECT_GE(problem.x.norm(), 0.5);
  EXPECT_LE(summary.final_cost, summary.initial_cost);
}

TEST(LevenbergMarquardt, UnobservedParameterDoesNotChange) {
  Bowl problem;
  problem.observes_z = false;
  LevenbergMarquardt<3> solver;
  const LmSummary summary = solver.solve(problem);
  EXPECT_TRUE(converged(summary.status));
  EXPECT_NEAR(problem.x.head<2>().norm(), 0, 1e-6);
  EXPECT_EQ(problem.x.z(), 3);
}

TEST(LevenbergMarquardt, NextStepIsTheStepOfTheNextIteration) {
  Bowl problem;
  LevenbergMarquardt<3> solver;
  LmOptions options = LmOptions::one_step();
  LmSummary summary = solver.solve(problem, options);
  EXPECT_EQ(summary.status, LmStatus::kMaxIterations);
  EXPECT_EQ(problem.x, Vector3(1, 2, 3));
  const Vector3 next = solver.next_step();
  EXPECT_LT((problem.x + next).norm(), 1e-4) << "a bowl's minimum, but for the damping";
  EXPECT_NEAR(solver.next_decrease(), summary.initial_cost, 1e-4 * summary.initial_cost);
  options.max_iterations = 1;
  (void)solver.solve(problem, options);
  EXPECT_EQ(problem.x, Vector3(1, 2, 3) + next);

  problem.negative_curvature = true;
  (void)solver.solve(problem, LmOptions::one_step());
  EXPECT_EQ(solver.next_step(), Vector3(0, 0, 0)) << "there is none";
  EXPECT_EQ(solver.next_decrease(), 0);
}

TEST(LevenbergMarquardt, ReturnsSingularForNegativeCurvature) {
  Bowl problem;
  problem.negative_curvature = true;
  LevenbergMarquardt<3> solver;
  LmOptions options;
  options.max_iterations = 1000;
  options.max_damping = 1e3;
  LmSummary summary = solver.solve(problem, options);
  // −I + μ D has no Cholesky factor at any μ ≤ 1000, because D is bounded below by only 1e-12 of the largest
  // entry.
  EXPECT_EQ(summary.status, LmStatus::kSingular);
  EXPECT_EQ(problem.x, Vector3(1, 2, 3));
}

TEST(LevenbergMarquardt, ReturnsStalledWhenNoStepLowersTheCost) {
  Bowl problem;
  problem.gradient_lies = true;
  LevenbergMarquardt<3> solver;
  LmOptions options;
  options.max_iterations = 1000;
  options.step_tolerance = 0;
  options.max_damping = 1e6;
  const LmSummary summary = solver.solve(problem, options);
  EXPECT_EQ(summary.status, LmStatus::kStalled);
  EXPECT_EQ(problem.x, Vector3(1, 2, 3));
}

TEST(Cholesky, SolvesAndInverts) {
  Matrix4 A;
  A << 5, 1, 0.5, 0, 1, 4, 0.2, 0.3, 0.5, 0.2, 3, -1, 0, 0.3, -1, 2;
  Cholesky<4> cholesky;
  ASSERT_TRUE(cholesky.factor(A));
  const Vector4 b(1, -2, 3, 4);
  EXPECT_LT((A * cholesky.solve(b) - b).norm(), 1e-14);
  EXPECT_LT((A * cholesky.inverse() - Matrix4::Identity()).norm(), 1e-14);
  EXPECT_EQ(cholesky.inverse(), cholesky.inverse().transpose());
  EXPECT_NEAR(cholesky.solve_lower(b).squaredNorm(), b.dot(cholesky.solve(b)), 1e-13);
}

TEST(Cholesky, RejectsMatricesThatAreNotPositiveDefinite) {
  Cholesky<3> cholesky;
  Matrix3 A = Matrix3::Identity();
  A(2, 2) = -1;
  EXPECT_FALSE(cholesky.factor(A));
  A = Vector3(1, 2, 3) * Vector3(1, 2, 3).transpose();  // rank 1
  EXPECT_FALSE(cholesky.factor(A));
  EXPECT_FALSE(cholesky.factor(Matrix3::Zero()));
  A = Matrix3::Identity();
  A(1, 0) = kNaN;
  EXPECT_FALSE(cholesky.factor(A));
  A = Matrix3::Identity();
  A(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(cholesky.factor(A));
}

}  // namespace
}  // namespace plvo
