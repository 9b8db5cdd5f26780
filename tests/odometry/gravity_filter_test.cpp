// SPDX-License-Identifier: Apache-2.0
// Compares the gravity filter with a dense filter without block structure, and tests it over a long chain of
// drifting poses.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "dense.hpp"
#include "plvo/odometry/gravity_filter.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Dense;
using test::DenseVector;
using test::Gaussian;
using test::product;

Vector3 normal3(Gaussian& gaussian, double sigma) { return sigma * gaussian.vector<3>(); }

Matrix6 diagonal(double sigma_m, double sigma_rad) {
  Matrix6 C = Matrix6::Zero();
  for (int i = 0; i < 3; ++i) {
    C(i, i) = sigma_m * sigma_m;
    C(3 + i, 3 + i) = sigma_rad * sigma_rad;
  }
  return C;
}

// The errors δ of `from` and `current`, ε and β are one Gaussian of 18 dimensions; its Jacobian comes from
// finite differences.
TEST(GravityFilter, EqualsADenseKalmanStep) {
  Gaussian random(4);
  const Vector3 g = Vector3(0.1, 0.9, 0.2).normalized();
  PoseWithCovariance from;
  from.T_world_camera = {rotation_exp({0.3, -0.2, 0.5}), {1, 2, 3}};
  from.covariance = diagonal(0.02, 0.03);
  GravityFilter hold;
  const Se3 T_current_from{rotation_exp({-0.1, 0.2, 0.1}), {0.3, 0.1, -0.2}};
  const Matrix6 C_motion = diagonal(0.004, 0.006);
  PoseWithCovariance current = advance(from, T_current_from, C_motion);
  GravityPrior reading;
  reading.covariance = Matrix3::Identity() * 4e-4;
  reading.offset_sigma = 0.02;
  reading.down = current.T_world_camera.R.transpose() * g + normal3(random, 0.02);
  hold.read(reading, from, current);
  ASSERT_TRUE(hold.known());

  const auto joint = [](const PoseWithCovariance& a, const PoseWithCovariance& c, const GravityFilter& h) {
    Dense P = Dense::Zero(18, 18);
    Matrix6 A = Matrix6::Identity();
    A.block<3, 3>(0, 3) = -skew(c.T_world_camera.t - a.T_world_camera.t);
    P.block<6, 6>(0, 0) = a.covariance;
    P.block<6, 6>(6, 6) = c.covariance;
    P.block<6, 6>(6, 0) = A * a.covariance;
    P.block<6, 6>(0, 12) = a.covariance_with_gravity;
    P.block<6, 6>(6, 12) = c.covariance_with_gravity;
    P.block<6, 6>(12, 12) = h.covariance();
    P.block<6, 6>(0, 6) = P.block<6, 6>(6, 0).transpose();
    P.block<6, 6>(12, 0) = P.block<6, 6>(0, 12).transpose();
    P.block<6, 6>(12, 6) = P.block<6, 6>(6, 12).transpose();
    return P;
  };
  // Two frames later; the last keyframe has drifted too.
  const auto shifts = [&] {
    OfEachKind of_each;
    for (int k = 0; k < kLandmarkKinds; ++k) of_each.col(k) = 0.01 * random.vector<6>();
    return of_each;
  };
  from = advance(current, {rotation_exp({0.1, 0.3, 0.2}), {0.2, -0.1, 0.3}}, diagonal(0.01, 0.02), shifts());
  current = advance(from, {rotation_exp({0.2, 0.1, -0.3}), {0.1, 0.4, 0.2}}, C_motion, shifts());
  reading.down = current.T_world_camera.R.transpose() * g + normal3(random, 0.03);
  const Dense P = joint(from, current, hold);
  EXPECT_GT(test::symmetric_eigenvalues(P)[0], -1e-12) << "a covariance";
  const auto predicted = [&](const DenseVector& x) {
    const Matrix3 R = rotation_exp(x.segment<3>(9)) * current.T_world_camera.R;
    return Vector3(R.transpose() * (hold.down_in_world() + x.segment<3>(12)) + hold.offset() + x.tail<3>());
  };
  const DenseVector none = DenseVector::Zero(18);
  Dense J(3, 18);
  for (int i = 0; i < 18; ++i) {
    DenseVector x = none;
    x[i] = 1e-6;
    J.col(i) = (predicted(x) - predicted(-x)) / 2e-6;
  }
  // Only the component across the direction counts.
  const Vector3 d = current.T_world_camera.R.transpose() * hold.down_in_world();
  const Vector3 u = d.cross(Vector3(1, 0, 0)).normalized();
  Dense U(2, 3);
  U.row(0) = u.transpose();
  U.row(1) = d.cross(u).transpose();
  const Dense H = product(U, J);
  const Dense PHt = product(P, H.transpose());
  const Dense S = product(H, PHt) + product(U, product(reading.covariance, U.transpose()));
  const Dense K = product(PHt, test::inverse(S));
  const DenseVector x = product(K, product(U, reading.down.normalized() - predicted(none)));
  const Dense after = P - product(K, product(H, P));

  PoseWithCovariance from_after = from, current_after = current;
  GravityFilter hold_after = hold;
  hold_after.read(reading, from_after, current_after);
  EXPECT_LT((boxminus(from_after.T_world_camera, from.T_world_camera) - x.head<6>()).norm(), 1e-6);
  EXPECT_LT((boxminus(current_after.T_world_camera, current.T_world_camera) - x.segment<6>(6)).norm(), 1e-6);
  EXPECT_LT((hold_after.down_in_world() - (hold.down_in_world() + x.segment<3>(12)).normalized()).norm(),
            1e-6);
  EXPECT_LT((hold_after.offset() - hold.offset() - x.tail<3>()).norm(), 1e-6);
  EXPECT_GT(x.head<6>().norm(), 1e-3) << "there was something to correct";
  EXPECT_LT((from_after.covariance - after.block<6, 6>(0, 0)).norm(), 1e-6 * P.norm());
  EXPECT_LT((current_after.covariance - after.block<6, 6>(6, 6)).norm(), 1e-6 * P.norm());
  EXPECT_LT((current_after.covariance_with_gravity - after.block<6, 6>(6, 12)).norm(), 1e-6 * P.norm());
  EXPECT_LT((from_after.covariance_with_gravity - after.block<6, 6>(0, 12)).norm(), 1e-6 * P.norm());
  EXPECT_LT((hold_after.covariance() - after.block<6, 6>(12, 12)).norm(), 1e-6 * P.norm());

  // A shift is corrected as the error that it is.
  Dense X = Dense::Zero(18, kLandmarkKinds);
  X.topRows(6) = from.shifts;
  X.middleRows(6, 6) = current.shifts;
  const Dense X_after = X - product(K, product(H, X));
  EXPECT_LT((from_after.shifts - X_after.topRows(6)).norm(), 1e-6);
  EXPECT_LT((current_after.shifts - X_after.middleRows(6, 6)).norm(), 1e-6);
  EXPECT_GT((current_after.shifts - current.shifts).norm(), 1e-3) << "there was something to correct";
}

TEST(GravityFilter, LevelsTheWorldByAReading) {
  const Vector3 y(0, 1, 0);
  for (const Vector3& down :
       {Vector3(0, 1, 0), Vector3(0.1, 0.9, 0.2), Vector3(-0.7, 0.1, 0.4), Vector3(0, 0, 1),
        Vector3(0, 0, -1), Vector3(0.2, -0.9, 0.1), Vector3(0, -1, 0), Vector3(1, -1e-9, 0)}) {
    GravityPrior reading;
    reading.down = 3 * down;
    reading.covariance = Matrix3::Identity() * 1e-4;
    reading.offset_sigma = 0.02;
    PoseWithCovariance pose;
    GravityFilter hold;
    hold.level(reading, pose);
    const Matrix3& R = pose.T_world_camera.R;
    EXPECT_TRUE(is_rotation(R));
    EXPECT_LT((R * down.normalized() - y).norm(), 1e-12) << down.transpose();
    EXPECT_EQ(pose.T_world_camera.t, Vector3(0, 0, 0));
    EXPECT_TRUE(hold.known());
    EXPECT_EQ(hold.down_in_world(), y);
    // Roll and pitch have the uncertainty of the reading. The heading is exact, because it defines the world.
    const Matrix3 C = pose.covariance.block<3, 3>(3, 3);
    EXPECT_NEAR(C(0, 0), 5e-4, 1e-15);
    EXPECT_NEAR(C(2, 2), 5e-4, 1e-15);
    EXPECT_EQ(C(1, 1), 0);
    EXPECT_EQ((pose.covariance.block<3, 6>(0, 0).norm()), 0);
    // The camera keeps its viewing direction, unless it looks straight up or down: the rotation is about a
    // horizontal axis, after a roll if the camera hangs upside down.
    const bool hangs = down.y() < 0;
    const Matrix3 roll = hangs ? Matrix3(Vector3(-1, -1, 1).asDiagonal()) : Matrix3(Matrix3::Identity());
    EXPECT_NEAR(rotation_log(R * roll).y(), 0, 1e-12) << down.transpose();
  }
}

// A cheap accelerometer in a camera that rotates back and forth. The tilt error agrees with its covariance at
// the first pose, and with the smaller covariance after more readings.
TEST(GravityFilter, TiltOfALevelWorldAgreesWithItsCovariance) {
  constexpr double kNoise = 0.05, kOffset = 0.02, kStep = 1e-3;
  constexpr int kRuns = 400, kReadings = 60;
  const Vector3 y(0, 1, 0);
  Gaussian random(11);
  double nees_first = 0, nees_last = 0, first = 0, last = 0;
  for (int run = 0; run < kRuns; ++run) {
    Matrix3 R_true = rotation_exp(normal3(random, 0.4));
    const Vector3 offset = normal3(random, kOffset);
    const auto reading = [&] {
      GravityPrior prior;
      prior.down = R_true.transpose() * y + offset + normal3(random, kNoise);
      prior.covariance = Matrix3::Identity() * (kNoise * kNoise);
      prior.offset_sigma = kOffset;
      return prior;
    };
    PoseWithCovariance pose;
    GravityFilter hold;
    hold.level(reading(), pose);
    const auto look = [&](double& tilt, double& nees) {
      // R_true = Exp(ω) R: the component of ω across y.
      const Vector3 off = pose.T_world_camera.R * R_true.transpose() * y - y;
      const Vector2 omega(-off.z(), off.x());
      Matrix2 C;
      C << pose.covariance(3, 3), pose.covariance(3, 5), pose.covariance(5, 3), pose.covariance(5, 5);
      tilt += omega.squaredNorm() / kRuns;
      nees += omega.dot(Vector2(C.inverse() * omega)) / kRuns;
    };
    look(first, nees_first);
    for (int i = 0; i < kReadings; ++i) {
      const Matrix3 R_now_before = rotation_exp({0.2 * std::sin(0.3 * i), 0.1, 0.15 * std::cos(0.2 * i)});
      PoseWithCovariance from = pose;
      pose = advance(from, {R_now_before, Vector3::Zero()}, diagonal(1e-3, kStep));
      R_true = R_true * (rotation_exp(normal3(random, kStep)) * R_now_before).transpose();
      hold.read(reading(), from, pose);
      EXPECT_EQ(hold.down_in_world(), y) << "the reading defines this world";
    }
    look(last, nees_last);
  }
  // 2 degrees of freedom over 400 runs: the mean has an SD of 0.1.
  EXPECT_NEAR(nees_first, 2, 0.4);
  EXPECT_NEAR(nees_last, 2, 0.4);
  EXPECT_NEAR(std::sqrt(first), std::sqrt(2.0) * std::hypot(kNoise, kOffset), 0.01);
  EXPECT_LT(std::sqrt(last), 0.4 * std::sqrt(first));
}

TEST(GravityFilter, IgnoresAJolt) {
  PoseWithCovariance pose;
  pose.covariance = diagonal(0.01, 0.001);
  GravityFilter hold;
  GravityPrior reading;
  reading.covariance = Matrix3::Identity() * 1e-4;
  PoseWithCovariance from = pose;
  hold.read(reading, from, pose);
  const PoseWithCovariance before = pose;
  for (const Vector3& down : {Vector3(1, 1, 0), Vector3(0, -1, 0), Vector3(0, 0, 1)}) {
    reading.down = down;
    from = pose;
    hold.read(reading, from, pose);
    EXPECT_EQ(pose.T_world_camera.R, before.T_world_camera.R);
    EXPECT_EQ(pose.covariance, before.covariance);
  }
}

struct Drift {
  double tilt_rad = 0, heading_rad = 0;  // at the end
  double nees = 0;                       // of the orientation about the two horizontal axes, per dimension
};

// A camera that looks around. The motions between keyframes have errors of the stated covariance; its
// accelerometer has an offset.
Drift drift(std::uint64_t seed, bool gravity) {
  Gaussian random(seed);
  constexpr int kSteps = 1500;
  constexpr double kStep_rad = 0.004, kReading = 0.05, kOffset = 0.03;
  const Vector3 g = Vector3(0.05, 1, -0.1).normalized();
  const Vector3 offset = normal3(random, kOffset);
  Se3 truth;
  PoseWithCovariance pose;
  GravityFilter hold;
  const Matrix6 C = diagonal(0.002, kStep_rad);
  for (int k = 0; k < kSteps; ++k) {
    const Se3 T_current_from{rotation_exp({0.02 * std::sin(0.07 * k), 0.03, 0.02 * std::sin(0.05 * k)}),
                             {0.01, 0, 0.02}};
    truth = truth * T_current_from.inverse();
    Vector6 error;
    error << normal3(random, 0.002), normal3(random, kStep_rad);
    PoseWithCovariance from = pose;
    pose = advance(from, boxplus(T_current_from, error), C);
    const Vector3 reading = truth.R.transpose() * g + offset + normal3(random, kReading);
    if (!gravity) continue;
    GravityPrior prior;
    prior.down = reading;
    prior.covariance = Matrix3::Identity() * (kReading * kReading);
    prior.offset_sigma = kOffset;
    hold.read(prior, from, pose);
  }
  const Vector3 e = rotation_log(truth.R * pose.T_world_camera.R.transpose());
  const Vector3 level = e - g.dot(e) * g;
  const Vector3 u = g.cross(Vector3(1, 0, 0)).normalized();
  Matrix<2, 3> U;
  U.row(0) = u.transpose();
  U.row(1) = g.cross(u).transpose();
  const Matrix2 C_level = U * pose.covariance.block<3, 3>(3, 3) * U.transpose();
  const Vector2 x = U * e;
  return {level.norm(), std::fabs(g.dot(e)), 0.5 * x.dot(Vector2(C_level.inverse() * x))};
}

TEST(GravityFilter, StopsTheDriftOfRollAndPitch) {
  double held = 0, free = 0, heading = 0, nees = 0;
  constexpr int kRuns = 30;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const Drift with = drift(static_cast<std::uint64_t>(seed), true);
    const Drift without = drift(static_cast<std::uint64_t>(seed), false);
    held += with.tilt_rad * with.tilt_rad / kRuns;
    free += without.tilt_rad * without.tilt_rad / kRuns;
    heading += with.heading_rad * with.heading_rad / kRuns;
    nees += with.nees / kRuns;
  }
  // 0.004 rad √1500 about each of two axes: 0.22 rad.
  EXPECT_GT(std::sqrt(free), 0.15);
  EXPECT_LT(std::sqrt(held), 0.05);
  EXPECT_GT(std::sqrt(heading), 0.08) << "gravity does not correct the heading";
  EXPECT_NEAR(nees, 1, 3 * std::sqrt(1.0 / kRuns))
      << "three standard deviations of the mean of 2 · 30 squares";
}

}  // namespace
}  // namespace plvo
