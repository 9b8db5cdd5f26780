// SPDX-License-Identifier: Apache-2.0
// A motion that other sensors tell: what is refused, its share of the cost against numeric derivatives, and
// what it makes of the joint estimate where vision fixes everything, and where it leaves something open.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "plvo/motion/motion_prior.hpp"
#include "plvo/motion/prior_constraint.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Gaussian;
using test::SimulatedPair;

Matrix6 some_covariance(Gaussian& gaussian) {
  Matrix6 L = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < i; ++j) L(i, j) = 0.003 * gaussian();
    L(i, i) = gaussian.uniform(0.005, 0.02);
  }
  return test::product(L, Matrix6(L.transpose()));
}

struct OnePrior {
  OnePrior(const Se3& T, const Matrix6& C) : set(T, C) {}
  PriorConstraint set;
};

TEST(MotionPrior, RefusesInvalidPriors) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(MotionPrior().validate().ok()) << "nothing is said, and nothing is wrong";
  MotionPrior good;
  good.rotation = {rotation_exp({0.1, 0.2, 0.3}), 1e-6 * Matrix3::Identity()};
  good.translation = {{0.1, 0, 0}, 1e-4 * Matrix3::Identity()};
  good.gravity = {{0, 9.8, 0}, 1e-2 * Matrix3::Identity(), 0.03};
  EXPECT_TRUE(good.validate().ok()) << good.validate().message();
  const auto refused = [&](auto spoil, const char* word) {
    MotionPrior bad = good;
    spoil(bad);
    const Status status = bad.validate();
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument) << word;
    EXPECT_NE(std::string(status.message()).find(word), std::string::npos) << status.message();
  };
  refused([&](MotionPrior& p) { p.rotation->R_now_before(1, 2) = nan; }, "rotation");
  refused([](MotionPrior& p) { p.rotation->R_now_before(1, 2) += 1e-3; }, "rotation");
  refused([](MotionPrior& p) { p.rotation->R_now_before *= -1; }, "rotation");
  refused([](MotionPrior& p) { p.rotation->covariance.setZero(); }, "rotation");
  refused([&](MotionPrior& p) { p.rotation->covariance(0, 0) = nan; }, "rotation");
  refused([](MotionPrior& p) { p.rotation->covariance(0, 1) = 1e-7; }, "rotation");
  refused([](MotionPrior& p) { p.rotation->covariance(2, 2) *= -1; }, "rotation");
  refused([](MotionPrior& p) { p.rotation->covariance *= 1e-20; }, "rotation");
  refused([&](MotionPrior& p) { p.translation->t_now_before.y() = nan; }, "translation");
  refused([](MotionPrior& p) { p.translation->t_now_before.y() = 1e9; }, "translation");
  refused([](MotionPrior& p) { p.translation->covariance *= 1e30; }, "translation");
  refused([](MotionPrior& p) { p.gravity->down.setZero(); }, "gravity");
  refused([&](MotionPrior& p) { p.gravity->down.z() = nan; }, "gravity");
  refused([&](MotionPrior& p) { p.gravity->covariance(1, 1) = -1; }, "gravity");
  refused([&](MotionPrior& p) { p.gravity->offset_sigma = nan; }, "gravity");
  refused([](MotionPrior& p) { p.gravity->offset_sigma = -1; }, "gravity");
}

TEST(PriorConstraint, GradientIsThatOfItsCost) {
  Gaussian gaussian(3);
  for (const RobustLoss loss : {RobustLoss::kNone, RobustLoss::kHuber})
    for (int trial = 0; trial < 20; ++trial) {
      const Se3 T_propagated = test::random_motion(gaussian);
      OnePrior prior(T_propagated, some_covariance(gaussian));
      const RobustKernel kernel(loss, prior.set.dof());
      Vector6 away;
      away << 0.02 * gaussian.vector<3>(), 0.02 * gaussian.vector<3>();
      const Se3 T = boxplus(T_propagated, away);
      const auto cost = [&](const Vector6& step) {
        JointInformation unused;
        return prior.set.linearize(boxplus(T, step), {}, kernel, unused);
      };
      JointInformation sum;
      prior.set.linearize(T, {}, kernel, sum);
      for (int i = 0; i < 6; ++i) {
        Vector6 step = Vector6::Zero();
        step[i] = 1e-5;
        const double numeric = (cost(step) - cost(Vector6(-step))) / 2e-5;
        EXPECT_NEAR(sum.g[i], numeric, 1e-5 * (1 + std::fabs(numeric)));
      }
    }
}

// Without noise of vision's own: the product of two Gaussians, computed directly.
TEST(PriorConstraint, AddsItsInformationToThatOfVision) {
  Gaussian gaussian(5);
  const SimulatedPair pair = test::simulate(gaussian, 30, 10);
  test::Bench bench;
  const MotionEstimate alone = bench.estimate(pair);
  ASSERT_EQ(alone.status, StatusCode::kOk);
  const Matrix6 C = some_covariance(gaussian);
  Vector6 away;
  away << 0.002, -0.001, 0.003, 0.001, 0.002, -0.002;
  const Se3 T_propagated = boxplus(alone.T_current_reference, away);
  OnePrior prior(T_propagated, C);
  bench.load(pair);
  const std::array<CostTerm*, 1> others{&prior.set};
  const MotionEstimate both =
      estimate_motion(bench.sets, others, MotionReferences{}, {}, {}, 1, {&T_propagated}, bench.arena);
  ASSERT_EQ(both.status, StatusCode::kOk);
  const Matrix6 H = test::inverse(alone.C_H);
  const Matrix6 Lambda = test::inverse(C);
  const Vector6 expected = test::inverse(H + Lambda) * (Lambda * away);
  const Vector6 moved = boxminus(both.T_current_reference, alone.T_current_reference);
  EXPECT_LT((moved - expected).cwiseAbs().maxCoeff(), 0.05 * away.cwiseAbs().maxCoeff());
  EXPECT_LT(((test::inverse(both.C_H) - H - Lambda).array() / (H + Lambda).norm()).abs().maxCoeff(), 0.02);
}

// All lines parallel: nothing is seen of the motion along them.
TEST(PriorConstraint, DeterminesDirectionsThatVisionLeavesOpen) {
  Gaussian gaussian(7);
  SimulatedPair pair;
  pair.truth = test::random_motion(gaussian);
  const Vector3 along = Vector3(1, 0.2, 0.1).normalized();
  for (int i = 0; i < 25; ++i) {
    const Vector3 a = test::random_point(gaussian);
    pair.add_line(gaussian, a, a + 0.6 * along);
  }
  test::Bench bench;
  bench.load(pair);
  EXPECT_EQ(estimate_motion(bench.sets, {}, MotionReferences{}, {}, {}, 1, {&pair.truth}, bench.arena).status,
            StatusCode::kDegenerate);

  Matrix6 C = Matrix6::Identity() * 1e-6;
  C.block<3, 3>(0, 0) = Matrix3::Identity() * 0.04;
  // In the current frame's axes.
  const Vector3 open = pair.truth.R * along;
  const Vector3 across = open.cross(Vector3(0, 1, 0)).normalized();
  Vector6 error;
  error << 0.2 * open + 0.004 * across, 2e-4, -1e-4, 3e-4;
  const Se3 T_propagated = boxplus(pair.truth, error);
  OnePrior prior(T_propagated, C);
  constexpr LmOptions kAsTracking{.max_iterations = 20, .step_tolerance = 1e-6, .decrease_tolerance = 1e-9};
  MotionConfig config;
  config.max_sigma_m = config.max_sigma_rad = 1e6;
  bench.load(pair);
  const std::array<CostTerm*, 1> others{&prior.set};
  const MotionEstimate held = estimate_motion(bench.sets, others, MotionReferences{}, config, kAsTracking, 1,
                                              {&T_propagated}, bench.arena);
  ASSERT_EQ(held.status, StatusCode::kOk);
  // Little along the lines, though the noise of their directions looks like information; across them as much
  // as vision.
  const Matrix3 C_t = held.C_H.block<3, 3>(0, 0);
  EXPECT_GT(std::sqrt(open.dot(C_t * open)), 0.03);
  EXPECT_LT(std::sqrt(open.dot(C_t * open)), 0.21);
  EXPECT_LT(std::sqrt(across.dot(C_t * across)), 0.003);
  const Vector3 t_error = held.T_current_reference.t - pair.truth.t;
  EXPECT_LT(std::fabs(across.dot(t_error)), 0.003) << "vision corrects the prior across";
}

// A room of 30 points and an object of 70 in a wider part of the image: the object has more of the evidence.
// A gyro tells one of their rotations.
TEST(PriorConstraint, AGyroDecidesWhichOfTwoMotionsIsTheCameras) {
  Gaussian gaussian(8);
  for (std::uint64_t trial = 0; trial < 10; ++trial) {
    SimulatedPair pair;
    const Se3 room = boxplus(Se3(), 0.02 * gaussian.vector<6>());
    const Se3 object = boxplus(room, Vector6(0.1, -0.06, 0.05, 0.03, 0.04, -0.03));
    const auto add = [&](const Se3& T, int n, double left, double right) {
      pair.truth = T;
      for (int i = 0; i < n; ++i) {
        const double z = gaussian.uniform(2, 4);
        pair.add_point(gaussian, {z * gaussian.uniform(left, right), z * gaussian.uniform(-0.4, 0.4), z});
      }
    };
    add(room, 30, -0.5, -0.2);
    add(object, 70, -0.2, 0.5);
    const auto estimate_with = [&](const Matrix3& R) {
      Matrix6 C = Matrix6::Identity();
      C.block<3, 3>(3, 3) *= 1e-6;
      OnePrior gyro({R, Vector3::Zero()}, C);
      const std::array<CostTerm*, 1> others{&gyro.set};
      test::Bench bench;
      bench.load(pair);
      return estimate_motion(bench.sets, others, MotionReferences{}, {}, {}, trial, nullptr, bench.arena);
    };
    for (const Se3* camera : {&room, &object}) {
      const MotionEstimate estimate = estimate_with(camera->R);
      ASSERT_EQ(estimate.status, StatusCode::kOk) << trial;
      EXPECT_LT(boxminus(estimate.T_current_reference, *camera).norm(), 0.01) << trial;
      EXPECT_FALSE(estimate.contradicted) << trial;
    }
    // A gyro that tells neither is outweighed.
    const MotionEstimate estimate = estimate_with(rotation_exp({0, 0.3, 0}));
    ASSERT_EQ(estimate.status, StatusCode::kOk) << trial;
    EXPECT_LT(boxminus(estimate.T_current_reference, object).norm(), 0.02) << trial;
    EXPECT_TRUE(estimate.contradicted) << trial;
  }
}

TEST(PriorConstraint, TheJointCovarianceMatchesTheErrors) {
  Gaussian gaussian(11);
  double nees = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    const SimulatedPair pair = test::simulate(gaussian, 12, 0);
    const Matrix6 C = some_covariance(gaussian);
    const Se3 T_propagated = boxplus(pair.truth, gaussian.draw<6>(C));
    OnePrior prior(T_propagated, C);
    test::Bench bench;
    bench.load(pair);
    const std::array<CostTerm*, 1> others{&prior.set};
    MotionConfig config;
    config.robust = false;
    const MotionEstimate estimate =
        estimate_motion(bench.sets, others, MotionReferences{}, config, {}, 1, {&T_propagated}, bench.arena);
    ASSERT_EQ(estimate.status, StatusCode::kOk);
    const Vector6 e = boxminus(pair.truth, estimate.T_current_reference);
    nees += e.dot(Vector6(test::inverse(estimate.C_H) * e)) / kTrials;
  }
  EXPECT_NEAR(nees, 6, 0.8);  // SD of the mean: 0.2
}

// The prior is of the motion from the last frame, the estimate from a keyframe whose distance to it is
// uncertain: the prior alone must come out as what both covariances make.
TEST(PriorConstraint, IsTransformedFromTheLastFrameToTheKeyframe) {
  Gaussian gaussian(13);
  const Se3 T_last_keyframe = test::random_motion(gaussian);
  const Se3 T_current_last = test::random_motion(gaussian);
  const Matrix6 C_last = some_covariance(gaussian), C = some_covariance(gaussian);
  OnePrior prior(T_current_last, C);
  prior.set.set_reference(1, 0);
  const std::array<CostTerm*, 1> others{&prior.set};
  const CostTerms terms({}, others);
  MotionReferences references;
  references[1] = {T_last_keyframe, C_last};
  const Se3 T = T_current_last * T_last_keyframe;
  MotionProblem problem(terms, references, {}, MotionProblem::make_kernels(terms, RobustLoss::kNone), T);
  Matrix6 H;
  Vector6 g;
  EXPECT_NEAR(problem.linearize(Vector6::Zero(), H, g), 0, 1e-20);
  const Matrix6 expected = compose_covariance(T_current_last, C, T_last_keyframe, C_last);
  EXPECT_LT((test::inverse(H) - expected).norm(), 1e-8 * expected.norm());
}

}  // namespace
}  // namespace plvo
