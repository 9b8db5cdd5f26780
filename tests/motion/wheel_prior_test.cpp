// SPDX-License-Identifier: Apache-2.0
// The prior that wheels give: against twists that are integrated in steps of a ten-thousandth, its covariance
// against Monte Carlo, and input that is refused.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "plvo/motion/wheel_prior.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Gaussian;

// A camera 0.3 m ahead of the base and 0.6 m above it that looks ahead, a little down and to the left.
Se3 camera_on_robot() {
  Matrix3 R_body_optical;
  R_body_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {rotation_exp({0, 0, 0.2}) * rotation_exp({0, 0.3, 0}) * R_body_optical, {0.3, -0.05, 0.6}};
}

Matrix6 twist_covariance(const Vector6& sigma) {
  Matrix6 C = Matrix6::Zero();
  C.diagonal() = sigma.cwiseProduct(sigma);
  C(0, 5) = C(5, 0) = 0.4 * sigma[0] * sigma[5];
  return C;
}

// A quick robot in a narrow bend, and one that slides sideways and nods.
std::vector<WheelStep> some_steps() {
  Vector6 sigma, bend, slide;
  sigma << 0.05, 0.02, 0.01, 0.02, 0.03, 0.1;
  bend << 1.5, 0, 0, 0, 0, 2.5;
  slide << -0.4, 0.3, 0.05, 0.1, -0.2, -1.2;
  return {{0.02, bend, twist_covariance(sigma)},
          {0.5, slide, twist_covariance(2 * sigma)},
          {0.3, bend, twist_covariance(0.5 * sigma)}};
}

// Euler's method in small steps: the base moves straight, then turns.
Se3 slow_motion(const std::vector<WheelStep>& steps) {
  constexpr int kPieces = 20000;
  Se3 T_before_now;
  for (const WheelStep& step : steps) {
    const double dt = step.seconds / kPieces;
    for (int k = 0; k < kPieces; ++k) {
      T_before_now.t += dt * (T_before_now.R * step.twist.head<3>());
      T_before_now.R = renormalise(T_before_now.R * rotation_exp(Vector3(dt * step.twist.tail<3>())));
    }
  }
  return T_before_now;
}

Se3 of_camera(const Se3& T_before_now, const Se3& T_base_camera) {
  return T_base_camera.inverse() * T_before_now.inverse() * T_base_camera;
}

MotionPrior prior_of(const std::vector<WheelStep>& steps, double error_s, const Se3& T_base_camera) {
  MotionPrior prior;
  const Status status = wheel_prior(steps, error_s, T_base_camera, prior);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE(prior.rotation && prior.translation && !prior.gravity);
  return prior;
}

Se3 motion(const MotionPrior& prior) {
  return {prior.rotation->R_now_before, prior.translation->t_now_before};
}

TEST(WheelPrior, AgreesWithAFineIntegration) {
  const Se3 expected = of_camera(slow_motion(some_steps()), camera_on_robot());
  const Se3 T = motion(prior_of(some_steps(), 0, camera_on_robot()));
  EXPECT_LT(boxminus(T, expected).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_GT(expected.t.norm(), 0.3) << "it has moved";
}

TEST(WheelPrior, DrivesStraightAheadAlongTheCamerasAxis) {
  Matrix3 R_body_optical;
  R_body_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  WheelStep step{0.1, Vector6::Zero(), Matrix6::Identity()};
  step.twist[0] = 2;
  const Se3 T = motion(prior_of({step}, 0, {R_body_optical, {0.2, 0, 0.5}}));
  EXPECT_LT((T.t - Vector3(0, 0, -0.2)).norm(), 1e-12) << "the camera before is 0.2 m behind";
  EXPECT_LT((T.R - Matrix3::Identity()).norm(), 1e-12);
  // A turn to the left about the base, 0.2 m behind the camera: the camera before is to the right and back.
  step.twist << 0, 0, 0, 0, 0, 1;
  const Se3 turn = motion(prior_of({step}, 0, {R_body_optical, {0.2, 0, 0.5}}));
  EXPECT_NEAR(turn.t.x(), 0.2 * std::sin(0.1), 1e-12);
  EXPECT_NEAR(turn.t.z(), -0.2 * (1 - std::cos(0.1)), 1e-12);
}

TEST(WheelPrior, DividedStepsGiveTheSameMotion) {
  std::vector<WheelStep> pieces;
  for (const WheelStep& step : some_steps())
    for (int k = 0; k < 7; ++k) pieces.push_back({step.seconds / 7, step.twist, step.covariance});
  const MotionPrior whole = prior_of(some_steps(), 1, camera_on_robot());
  const MotionPrior cut = prior_of(pieces, 1, camera_on_robot());
  EXPECT_LT(boxminus(motion(cut), motion(whole)).norm(), 1e-12);
  // An error that outlasts every step grows with time, in however many pieces that comes.
  const Matrix3 &A = whole.rotation->covariance, &B = cut.rotation->covariance;
  EXPECT_LT((A - B).norm(), 1e-2 * A.norm());
}

// Rounding of the series where it is longest, and a step without a turn.
TEST(WheelPrior, IsCorrectForHalfATurnAndForNoRotation) {
  WheelStep step{1, Vector6::Zero(), Matrix6::Identity()};
  step.twist << 3, 1, 0, 0, 0, 3.14159;
  EXPECT_LT(boxminus(motion(prior_of({step}, 0, {})), slow_motion({step}).inverse()).norm(), 1e-3);
  const double radius = 1 / 3.14159, angle = 3.14159;
  const Vector3 end(radius * (3 * std::sin(angle) - 1 * (1 - std::cos(angle))),
                    radius * (3 * (1 - std::cos(angle)) + 1 * std::sin(angle)), 0);
  EXPECT_LT((motion(prior_of({step}, 0, {})).inverse().t - end).norm(), 1e-9);
  step.twist.setZero();
  EXPECT_LT(boxminus(motion(prior_of({step}, 0, camera_on_robot())), Se3{}).norm(), 1e-15);
}

// Twists with the noise that their covariances state: the scatter of the camera's motion is the prior's
// covariance, each entry in units of its standard deviations.
TEST(WheelPrior, CovarianceIsTheScatterOfMonteCarlo) {
  constexpr int kTrials = 4000;
  std::vector<WheelStep> steps = some_steps();
  for (WheelStep& step : steps) step.covariance *= 0.25;  // first order holds for small errors
  for (const double error_s : {0.0, 0.8}) {
    const MotionPrior prior = prior_of(steps, error_s, camera_on_robot());
    Gaussian gaussian(7);
    Matrix6 scatter = Matrix6::Zero();
    Vector6 mean = Vector6::Zero();
    for (int k = 0; k < kTrials; ++k) {
      std::vector<WheelStep> noisy = steps;
      for (WheelStep& step : noisy) {
        const double lasts_s = std::max(error_s, step.seconds);
        const Matrix6 C = step.covariance * (lasts_s / step.seconds);
        step.twist += gaussian.draw<6>(C);
      }
      const Vector6 error = boxminus(motion(prior_of(noisy, error_s, camera_on_robot())), motion(prior));
      scatter += error * error.transpose() / kTrials;
      mean += error / kTrials;
    }
    Matrix6 expected = Matrix6::Zero();
    expected.block<3, 3>(0, 0) = prior.translation->covariance;
    expected.block<3, 3>(3, 3) = prior.rotation->covariance;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        if ((i < 3) != (j < 3)) continue;
        const double unit = std::sqrt(expected(i, i) * expected(j, j));
        EXPECT_NEAR(scatter(i, j) / unit, expected(i, j) / unit, 0.1) << i << ' ' << j << ' ' << error_s;
      }
    for (int i = 0; i < 6; ++i) EXPECT_LT(std::abs(mean[i]), 0.1 * std::sqrt(expected(i, i))) << i;
  }
}

TEST(WheelPrior, RefusesInvalidSteps) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const std::vector<WheelStep>& steps, double error_s, const Se3& T,
                          const char* word) {
    MotionPrior prior;
    prior.gravity.emplace();
    const Status status = wheel_prior(steps, error_s, T, prior);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument) << word;
    EXPECT_NE(std::string(status.message()).find(word), std::string::npos) << status.message();
    EXPECT_FALSE(prior.tells_motion() || prior.gravity) << "nothing is left of an earlier prior";
  };
  refused({}, 0, {}, "a step at least");
  const auto spoilt = [](auto spoil) {
    WheelStep step = some_steps()[1];
    spoil(step);
    return std::vector<WheelStep>{some_steps()[0], step};
  };
  refused(spoilt([](WheelStep& s) { s.seconds = 0; }), 0, {}, "longer than 0 s");
  refused(spoilt([&](WheelStep& s) { s.seconds = nan; }), 0, {}, "longer than 0 s");
  refused(spoilt([&](WheelStep& s) { s.twist[2] = nan; }), 0, {}, "finite");
  refused(spoilt([&](WheelStep& s) { s.covariance(1, 1) = nan; }), 0, {}, "finite");
  refused(spoilt([](WheelStep& s) { s.twist[5] = 10; }), 0, {}, "at most pi");
  refused(spoilt([](WheelStep& s) { s.covariance.diagonal().setConstant(-1); }), 0, {}, "positive definite");
  refused(spoilt([](WheelStep& s) { s.twist[0] = 1e5; }), 0, {}, "at most 1000 m");
  refused(some_steps(), -1, {}, "error_s");
  refused(some_steps(), nan, {}, "error_s");
  refused(some_steps(), 0, {2 * Matrix3::Identity(), Vector3::Zero()}, "T_base_camera");
  refused(some_steps(), 0, {Matrix3::Identity(), Vector3(0, nan, 0)}, "T_base_camera");
}

}  // namespace
}  // namespace plvo
