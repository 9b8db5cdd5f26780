// SPDX-License-Identifier: Apache-2.0
// The recursion of the disagreement, compared with the sums over all frames that it stands for.
#include "plvo/odometry/disagreement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dense.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Gaussian;

constexpr double kInterval_s = 1.0 / 30;

struct Step {
  PoseWithCovariance last, pose;
  Se3 T_current_last;
  Matrix6 C;
  double elapsed_s = kInterval_s;
};

// Every frame is chained to the one before.
Step step_from(const PoseWithCovariance& last, const Se3& T_current_last, const Matrix6& C,
               const OfEachKind& shifts) {
  return {last, advance(last, T_current_last, C, shifts), T_current_last, C};
}

std::vector<Step> random_steps(int count, std::uint64_t seed) {
  Gaussian gaussian(seed);
  PoseWithCovariance pose;
  pose.T_world_camera = {rotation_exp(gaussian.vector<3>()), gaussian.vector<3>()};
  std::vector<Step> steps;
  for (int i = 0; i < count; ++i) {
    const Se3 T{rotation_exp(0.3 * gaussian.vector<3>()), 0.3 * gaussian.vector<3>()};
    Matrix6 C = 1e-6 * Matrix6::Identity();
    OfEachKind shifts;
    for (int k = 0; k < kLandmarkKinds; ++k) {
      const Vector6 e = 1e-3 * gaussian.vector<6>();
      C += e * e.transpose();
      shifts.col(k) = 1.5e-3 * gaussian.vector<6>();
    }
    steps.push_back(step_from(pose, T, C, shifts));
    steps.back().elapsed_s = kInterval_s * (1 + i % 4);
    pose = steps.back().pose;
  }
  return steps;
}

double inflation(const std::vector<Step>& steps) {
  Disagreement disagreement;
  for (const Step& step : steps)
    disagreement.note(step.last, step.pose, step.T_current_last, step.C, step.elapsed_s);
  return disagreement.inflation();
}

// In the axes of the world, with the errors of every frame moved to the last one.
double inflation_by_sums(const std::vector<Step>& steps) {
  const PoseWithCovariance& end = steps.back().pose;
  OfEachKind S = OfEachKind::Zero();
  Matrix6 N = Matrix6::Zero();
  double weight = 1;
  for (std::size_t i = steps.size(); i-- > 0;) {
    const Step& step = steps[i];
    const Matrix6 A = derivative_of_advance(step.pose, end);
    S += weight * A * (step.pose.shifts - derivative_of_advance(step.last, step.pose) * step.last.shifts);
    PoseWithCovariance exact = step.last;
    exact.covariance.setZero();
    N += weight * weight * A * advance(exact, step.T_current_last, step.C).covariance * A.transpose();
    weight *= 0.5 / (0.5 + step.elapsed_s);
  }
  return 1 + kLandmarkKinds * ((S.transpose() * test::inverse(N) * S).trace() / 6 - 1);
}

// One kind demands the same shift in every frame, and the camera goes straight on.
std::vector<Step> steady(double shift_sigmas, int count) {
  const Se3 forward{Matrix3::Identity(), {0, 0, -0.02}};
  OfEachKind shifts = OfEachKind::Zero();
  shifts(0, 2) = shift_sigmas * 1e-3;
  std::vector<Step> steps;
  PoseWithCovariance pose;
  for (int i = 0; i < count; ++i) {
    steps.push_back(step_from(pose, forward, 1e-6 * Matrix6::Identity(), shifts));
    pose = steps.back().pose;
  }
  return steps;
}

TEST(Disagreement, IsTheSumOverFrames) {
  int larger = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::vector<Step> steps = random_steps(40, seed);
    const double expected = inflation_by_sums(steps);
    EXPECT_NEAR(inflation(steps), std::max(expected, 1.0), 1e-6 * std::abs(expected)) << seed;
    larger += expected > 1 ? 1 : 0;
  }
  EXPECT_GT(larger, 10);
}

TEST(Disagreement, DoesNotDependOnTheWorld) {
  Gaussian gaussian(30);
  const std::vector<Step> steps = random_steps(40, 2);
  const Se3 other{rotation_exp(gaussian.vector<3>()), gaussian.vector<3>()};
  std::vector<Step> moved = steps;
  for (Step& step : moved)
    for (PoseWithCovariance* pose : {&step.last, &step.pose}) {
      pose->T_world_camera = other * pose->T_world_camera;
      pose->shifts.topRows<3>() = (other.R * pose->shifts.topRows<3>()).eval();
      pose->shifts.bottomRows<3>() = (other.R * pose->shifts.bottomRows<3>()).eval();
    }
  EXPECT_NEAR(inflation(moved), inflation(steps), 1e-6 * inflation(steps));
}

TEST(Disagreement, IsOneWithoutShifts) {
  EXPECT_EQ(Disagreement().inflation(), 1);
  EXPECT_EQ(inflation(steady(0, 30)), 1);
  EXPECT_EQ(inflation(steady(0.1, 300)), 1);
}

TEST(Disagreement, GrowsIfTheShiftIsTheSameInEveryFrame) {
  // One SD a frame is lost in the noise of one frame, and over half a second it is not.
  EXPECT_EQ(inflation(steady(1, 1)), 1);
  EXPECT_GT(inflation(steady(1, 30)), 3);
}

TEST(Disagreement, EndsWhenTheKindsAgreeAgain) {
  std::vector<Step> steps = steady(3, 60);
  EXPECT_GT(inflation(steps), 30);
  PoseWithCovariance pose = steps.back().pose;
  for (int i = 0; i < 90; ++i) {
    steps.push_back(step_from(pose, steps.front().T_current_last, steps.front().C, OfEachKind::Zero()));
    pose = steps.back().pose;
  }
  EXPECT_EQ(inflation(steps), 1);
}

TEST(Disagreement, HasABound) {
  EXPECT_EQ(inflation(steady(1e9, 30)), 1000);
  EXPECT_EQ(inflation(steady(1e200, 30)), 1000);
}

}  // namespace
}  // namespace plvo
