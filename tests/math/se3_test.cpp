// SPDX-License-Identifier: Apache-2.0
#include "plvo/math/se3.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "numeric_jacobian.hpp"
#include "plvo/base/random.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

Vector3 random_direction(Random& random) {
  while (true) {
    const Vector3 v(2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1);
    const double n = v.norm();
    if (n > 0.1 && n < 1) return v / n;
  }
}

Se3 random_pose(Random& random) {
  return {rotation_exp(random_direction(random) * (kPi * random.uniform())),
          random_direction(random) * (3 * random.uniform())};
}

Matrix6 random_covariance(Random& random) {
  Matrix6 A;
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = random.uniform() - 0.5;
  Matrix6 C = A.lazyProduct(A.transpose());
  C *= 1e-4;
  return C;
}

// The exponential of a matrix by its power series.
Matrix3 exponential_series(const Matrix3& W) {
  Matrix3 sum = Matrix3::Identity();
  Matrix3 term = Matrix3::Identity();
  for (int n = 1; n < 60; ++n) {
    term = (term * W / n).eval();
    sum += term;
  }
  return sum;
}

// Angles from 0 to π, dense at both ends, where the formulas switch.
const double kAngles[] = {0,       1e-300,   1e-12, 1e-9, 9.9e-9, 1e-8,       1.1e-8,     1e-5,
                          9.99e-5, 1.001e-4, 1e-3,  0.1,  0.5,    1,          1.5,        2,
                          2.5,     3,        3.1,   3.14, 3.1415, 3.14159265, kPi - 1e-9, kPi};

TEST(Rotation, ExpEqualsThePowerSeries) {
  Random random(1);
  for (double angle : kAngles) {
    for (int i = 0; i < 20; ++i) {
      const Vector3 omega = random_direction(random) * angle;
      EXPECT_LT((rotation_exp(omega) - exponential_series(skew(omega))).norm(), 4e-15) << angle;
    }
  }
}

TEST(Rotation, LogInvertsExpAtEveryAngle) {
  Random random(2);
  for (double angle : kAngles) {
    for (int i = 0; i < 50; ++i) {
      const Vector3 omega = random_direction(random) * angle;
      const Matrix3 R = rotation_exp(omega);
      const Vector3 back = rotation_log(R);
      EXPECT_LE(back.norm(), kPi * (1 + 1e-15));
      // At π both signs of the axis give the same rotation.
      const double error = std::min((back - omega).norm(), (back + omega).norm());
      EXPECT_LT(angle > kPi - 1e-8 ? error : (back - omega).norm(), 2e-14 + 1e-14 * angle) << angle;
      EXPECT_LT((rotation_exp(back) - R).norm(), 5e-15) << angle;
    }
  }
}

TEST(Rotation, LogKeepsTinyAngles) {
  const Vector3 omega(1e-10, -2e-10, 3e-10);
  EXPECT_LT((rotation_log(rotation_exp(omega)) - omega).norm(), 1e-24);
}

TEST(Rotation, FrameAlongIsARotationWhoseZAxisIsTheDirection) {
  for (const Vector3& direction :
       {Vector3(0, 0, 1), Vector3(-1, 0, 0), Vector3(1, 1, 1), Vector3(3, -2, 0.1)}) {
    const Vector3 d = direction / direction.norm();
    const Matrix3 frame = frame_along(d);
    EXPECT_EQ(frame.col(2), d);
    EXPECT_LT((frame.transpose() * frame - Matrix3::Identity()).norm(), 1e-15 * 4);
    EXPECT_GT(frame.determinant(), 0);
  }
}

TEST(Rotation, LogOfHalfTurnsHasNormPi) {
  for (int axis = 0; axis < 3; ++axis) {
    Matrix3 R = -Matrix3::Identity();
    R(axis, axis) = 1;
    const Vector3 omega = rotation_log(R);
    EXPECT_NEAR(std::abs(omega(axis)), kPi, 1e-15);
    EXPECT_NEAR(omega.norm(), kPi, 1e-15);
  }
}

TEST(Rotation, RenormaliseSquaresTheError) {
  Random random(3);
  for (double noise : {1e-12, 1e-9, 1e-6, 1e-4}) {
    const Matrix3 R = random_pose(random).R;
    Matrix3 rough = R;
    for (int i = 0; i < 9; ++i) rough(i / 3, i % 3) += noise * (random.uniform() - 0.5);
    const Matrix3 fine = renormalise(rough);
    EXPECT_LT((fine * fine.transpose() - Matrix3::Identity()).norm(), 4 * noise * noise + 1e-15) << noise;
    EXPECT_LT((fine - R).norm(), 2 * noise + 1e-15);
  }
}

TEST(Rotation, RenormalisingKeepsAThousandCompositionsARotation) {
  Random random(4);
  Matrix3 R = Matrix3::Identity();
  for (int i = 0; i < 1000; ++i) R = renormalise(rotation_exp(random_direction(random) * 0.03) * R);
  EXPECT_LT((R * R.transpose() - Matrix3::Identity()).norm(), 2e-15);
  EXPECT_NEAR(R.determinant(), 1, 2e-15);
}

TEST(Quaternion, RoundTripsThroughEveryBranch) {
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    const Matrix3 R = rotation_exp(random_direction(random) * (kPi * random.uniform()));
    const Quaternion q = to_quaternion(R);
    EXPECT_GE(q.w, 0);
    EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1, 1e-15);
    EXPECT_LT((to_rotation(q) - R).norm(), 3e-15);
  }
  for (int axis = 0; axis < 3; ++axis) {
    Vector3 omega = Vector3::Zero();
    omega(axis) = kPi - 1e-6;
    const Matrix3 R = rotation_exp(omega);
    EXPECT_LT((to_rotation(to_quaternion(R)) - R).norm(), 3e-15);
  }
}

TEST(Quaternion, FollowsHamiltonsConventionAndIsNormalisedByToRotation) {
  const Quaternion quarter_turn_about_z = to_quaternion(rotation_exp({0, 0, kPi / 2}));
  EXPECT_NEAR(quarter_turn_about_z.z, 0.70710678118654752, 1e-15);
  EXPECT_NEAR(quarter_turn_about_z.w, 0.70710678118654752, 1e-15);
  const Vector3 y = to_rotation({0, 0, 5, 5}) * Vector3(1, 0, 0);
  EXPECT_LT((y - Vector3(0, 1, 0)).norm(), 1e-15);
  EXPECT_EQ(to_rotation({0, 0, 0, 0}), Matrix3(Matrix3::Identity()));
}

TEST(Se3, SatisfiesTheGroupLaws) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Se3 a = random_pose(random), b = random_pose(random);
    const Vector3 p = random_direction(random);
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-14);
    EXPECT_LT((a.inverse() * (a * p) - p).norm(), 1e-14);
    EXPECT_LT(((a * b).inverse() * p - b.inverse() * (a.inverse() * p)).norm(), 1e-14);
  }
}

TEST(Se3, BoxminusInvertsBoxplus) {
  Random random(7);
  for (double size : {1e-9, 1e-4, 0.1, 2.0}) {
    for (int i = 0; i < 50; ++i) {
      const Se3 T = random_pose(random);
      Vector6 delta;
      delta << random_direction(random) * size, random_direction(random) * size;
      EXPECT_LT((boxminus(boxplus(T, delta), T) - delta).norm(), 2e-14);
    }
  }
}

// Propagates C through f by central differences. f maps a ⊞-perturbation of the input to one of the output.
template <typename Function>
Matrix6 propagate_numerically(const Function& f, const Matrix6& C) {
  const Matrix6 J = numeric_jacobian<6, 6>(f, Vector6::Zero(), 1e-5);
  return Matrix6(J.lazyProduct(C)).lazyProduct(J.transpose());
}

TEST(Se3, CovarianceOfAProductMatchesNumericJacobians) {
  Random random(8);
  for (int i = 0; i < 20; ++i) {
    const Se3 a = random_pose(random), b = random_pose(random);
    const Matrix6 C_a = random_covariance(random), C_b = random_covariance(random);
    const auto by_a = [&](const Vector6& d) { return boxminus(boxplus(a, d) * b, a * b); };
    const auto by_b = [&](const Vector6& d) { return boxminus(a * boxplus(b, d), a * b); };
    const Matrix6 expected = propagate_numerically(by_a, C_a) + propagate_numerically(by_b, C_b);
    EXPECT_LT((compose_covariance(a, C_a, b, C_b) - expected).norm(), 1e-8 * expected.norm());
  }
}

TEST(Se3, CovarianceOfAnInverseMatchesNumericJacobians) {
  Random random(9);
  for (int i = 0; i < 20; ++i) {
    const Se3 a = random_pose(random);
    const Matrix6 C = random_covariance(random);
    const auto f = [&](const Vector6& d) { return boxminus(boxplus(a, d).inverse(), a.inverse()); };
    const Matrix6 expected = propagate_numerically(f, C);
    const Matrix6 got = inverse_covariance(a, C);
    EXPECT_LT((got - expected).norm(), 1e-8 * expected.norm());
    EXPECT_LT((inverse_covariance(a.inverse(), got) - C).norm(), 1e-12 * C.norm()) << "twice is once";
  }
}

TEST(Se3, IsFiniteChecksEveryEntry) {
  Se3 T;
  EXPECT_TRUE(T.is_finite());
  T.t.z() = std::nan("");
  EXPECT_FALSE(T.is_finite());
  T = Se3{};
  T.R(2, 0) = HUGE_VAL;
  EXPECT_FALSE(T.is_finite());
}

}  // namespace
}  // namespace plvo
