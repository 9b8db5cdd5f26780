// SPDX-License-Identifier: Apache-2.0
// Errors that all features of the current frame share: their fields, their elimination, and that the
// covariance of the motion knows of them.
#include "plvo/motion/nuisance_parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "numeric_jacobian.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Bench;
using test::Gaussian;
using test::SimulatedPair;

constexpr double kAngularRate = 0.3;  // rad/s
constexpr double kDepth = 0.004;      // m at 1 m
constexpr double kReadout = 0.03;     // s

CameraModel rolling_camera() {
  CameraModel camera;
  camera.readout_s = kReadout;
  return camera;
}

NuisanceParameters nuisance_parameters(double angular_rate = kAngularRate, double depth = kDepth) {
  return {Exposure(rolling_camera(), Vector6::Zero(), 0), angular_rate, depth};
}

NuisanceParameters::Vector draw(Gaussian& gaussian, const NuisanceParameters& shared) {
  NuisanceParameters::Vector value;
  for (int k = 0; k < NuisanceParameters::kCount; ++k) value[k] = shared.sigma(k) * gaussian();
  return value;
}

// The current frame's measurements as these errors falsify them.
SimulatedPair falsified(SimulatedPair pair, const NuisanceParameters& shared) {
  for (Point3d& point : pair.points_current) point.p += shared.shift(point.p);
  for (Line3d& line : pair.lines_current) {
    line.a += shared.shift(line.a);
    line.b += shared.shift(line.b);
  }
  return pair;
}

TEST(NuisanceParameters, TheAngularRateErrorMovesPointsByTheirRowTime) {
  const CameraModel camera = rolling_camera();
  const NuisanceParameters shared = nuisance_parameters();
  Gaussian gaussian(3);
  for (int i = 0; i < 50; ++i) {
    const Vector3 seen = test::random_point(gaussian);
    // Carried to mid-exposure by the velocity that was believed, and by the true one, which is ω larger.
    const auto carried = [&](const Vector3& omega) {
      Vector6 velocity = Vector6::Zero();
      velocity.tail<3>() = omega;
      return Vector3(Exposure(camera, velocity, 0).at_mid_exposure(seen));
    };
    const Vector3 omega = 0.1 * gaussian.vector<3>();
    NuisanceParameters error = shared;
    error.value.head<3>() = omega;
    const Vector3 measured = carried(Vector3::Zero());
    EXPECT_LT((measured - error.shift(measured) - carried(omega)).norm(), 1e-4 * measured.norm());
  }
}

TEST(NuisanceParameters, TheDepthErrorGrowsWithTheSquareOfDepthAlongTheRay) {
  NuisanceParameters shared = nuisance_parameters();
  shared.value[NuisanceField::kAngularRate] = 0.002;
  const Vector3 ray(0.3, -0.2, 1);
  for (const double depth : {0.5, 1.0, 3.0}) {
    const Vector3 expected = 0.002 * depth * depth * ray;
    EXPECT_LT((shared.shift(Vector3(depth * ray)) - expected).norm(), 1e-15);
  }
}

TEST(NuisanceParameters, AGlobalShutterHasNoAngularRateError) {
  const NuisanceParameters shared(Exposure(), 1, 0);
  EXPECT_FALSE(shared.any());
  EXPECT_EQ(shared.sigma(0), 0);
}

// The gradient of points and of lines with respect to the nuisance parameters, compared with central
// differences of the cost.
TEST(NuisanceParameters, TheirGradientMatchesDifferencesOfTheCost) {
  Gaussian gaussian(4);
  for (const bool of_lines : {false, true}) {
    Bench bench;
    const SimulatedPair pair = test::simulate(gaussian, of_lines ? 0 : 12, of_lines ? 12 : 0);
    bench.load(pair);
    ConstraintSet& set = *bench.sets[of_lines ? 1 : 0];
    test::flag_all(set);
    const RobustKernel kernel(RobustLoss::kNone, set.dof());
    NuisanceParameters at = nuisance_parameters();
    at.value = 0.5 * draw(gaussian, at);
    set.begin(pair.truth, at, RobustKernel(), 1);
    const auto evaluate = [&](const NuisanceParameters& shared) {
      JointInformation sum;
      const double cost = set.linearize(pair.truth, shared, kernel, sum);
      return std::pair(cost, sum);
    };
    const JointInformation sum = evaluate(at).second;
    EXPECT_EQ(sum.H, sum.H.transpose());
    for (int k = 0; k < NuisanceParameters::kCount; ++k) {
      const double h = 0.01 * at.sigma(k);
      NuisanceParameters more = at;
      NuisanceParameters less = at;
      more.value[k] += h;
      less.value[k] -= h;
      const double numeric = (evaluate(more).first - evaluate(less).first) / (2 * h);
      // In units of the gradient that one SD of the parameter makes.
      const double scale = sum.H(6 + k, 6 + k) * at.sigma(k);
      EXPECT_NEAR(sum.g[6 + k], numeric, 0.02 * (scale + std::fabs(numeric)))
          << k << (of_lines ? " of lines" : " of points");
    }
  }
}

// With points alone the whole problem is a quadratic in β: one elimination is exact.
TEST(NuisanceParameters, EliminationEqualsADenseSystem) {
  Gaussian gaussian(5);
  Bench bench;
  NuisanceParameters shared = nuisance_parameters();
  shared.value = draw(gaussian, shared);
  const SimulatedPair pair = falsified(test::simulate(gaussian, 60, 0), shared);
  bench.load(pair);
  test::flag_all(*bench.sets[0]);
  shared.value.setZero();
  const CostTerms terms(bench.sets);
  const auto kernels = MotionProblem::make_kernels(terms, RobustLoss::kNone);
  MotionProblem problem(terms, MotionReferences{}, shared, kernels, pair.truth);
  Matrix6 H;
  Vector6 g;
  const double cost = problem.linearize(Vector6::Zero(), H, g);

  JointInformation sum;
  const double plain = bench.sets[0]->linearize(pair.truth, shared, kernels[0], sum);
  for (int k = 0; k < NuisanceParameters::kCount; ++k)
    sum.H(6 + k, 6 + k) += 1 / (shared.sigma(k) * shared.sigma(k));
  const auto dense_H = Eigen::MatrixXd(sum.H);
  const Eigen::MatrixXd inverse = dense_H.inverse();
  const Eigen::MatrixXd expected = inverse.topLeftCorner(6, 6).inverse();
  EXPECT_LT((H - expected).norm(), 1e-6 * expected.norm());
  const Eigen::VectorXd beta = -dense_H.bottomRightCorner(7, 7).inverse() * Eigen::VectorXd(sum.g.tail<7>());
  const Eigen::VectorXd expected_g = sum.g.head<6>() + Eigen::MatrixXd(sum.H.block<6, 7>(0, 6)) * beta;
  EXPECT_LT((g - expected_g).norm(), 1e-6 * expected_g.norm());
  EXPECT_NEAR(cost, plain + 0.5 * beta.dot(Eigen::VectorXd(sum.g.tail<7>())), 1e-9 * plain);

  problem.accept();
  const Matrix6 C = inverse.topLeftCorner(6, 6);
  const NuisanceEstimate estimate = problem.shared(C);
  for (int k = 0; k < NuisanceParameters::kCount; ++k) {
    EXPECT_NEAR(estimate.value[k], beta[k], 1e-6 * shared.sigma(k));
    EXPECT_NEAR(estimate.variance[k], inverse(6 + k, 6 + k), 1e-6 * inverse(6 + k, 6 + k));
  }
}

// What the model is for: measurements with such errors, estimated with and without it.
TEST(NuisanceParameters, TheCovarianceContainsTheirUncertainty) {
  Gaussian gaussian(6);
  constexpr int kTrials = 200;
  double with = 0, without = 0, error_with = 0, error_without = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Bench bench;
    NuisanceParameters shared = nuisance_parameters();
    SimulatedPair pair = test::simulate(gaussian, 60, 20);
    shared.value = draw(gaussian, shared);
    pair = falsified(pair, shared);
    shared.value.setZero();
    const auto add = [&](const MotionEstimate& estimate, double& nees, double& error) {
      ASSERT_EQ(estimate.status, StatusCode::kOk);
      const Vector6 e = boxminus(pair.truth, estimate.T_current_reference);
      nees += e.dot(test::inverse(estimate.C_H) * e) / kTrials;
      error += e.head<3>().squaredNorm() / kTrials;
    };
    MotionConfig config;
    config.robust = false;
    add(bench.estimate(pair, config), without, error_without);
    add(bench.estimate(pair, config, 1, {nullptr, shared}), with, error_with);
  }
  // The mean of 200 values with six degrees of freedom lies within 5.5 … 6.5 in 19 of 20 cases; matches that
  // the gate of inliers takes away leave it a little larger.
  EXPECT_GT(with, 5);
  EXPECT_LT(with, 8);
  EXPECT_GT(without, 2 * with);
  EXPECT_LT(error_with, error_without);
}

}  // namespace
}  // namespace plvo
