// SPDX-License-Identifier: Apache-2.0
#include "plvo/math/covariance.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "plvo/base/random.hpp"
#include "plvo/math/se3.hpp"
#include "sound.hpp"

namespace plvo {
namespace {

// A covariance of this rank, with standard deviations over many orders of magnitude.
Matrix6 random_covariance(Random& random, int rank) {
  Matrix6 C = Matrix6::Zero();
  Vector6 deviation;
  for (int i = 0; i < 6; ++i) {
    deviation[i] = 1e-9;
    for (std::uint32_t n = random.below(10); n > 0; --n) deviation[i] *= 10;
  }
  for (int k = 0; k < rank; ++k) {
    Vector6 v;
    for (int i = 0; i < 6; ++i) v[i] = deviation[i] * (2 * random.uniform() - 1);
    C += v * v.transpose();
  }
  return C;
}

TEST(Covariance, LeavesAValidCovarianceUnchanged) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Matrix6 before = random_covariance(random, i % 7);
    Matrix6 C = before;
    EXPECT_TRUE(is_covariance(C)) << C;
    EXPECT_TRUE(make_bounded_covariance(C));
    EXPECT_EQ(C, before);
  }
}

TEST(Covariance, RepairsAnInvalidCovarianceToANearbyOne) {
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    Matrix6 C = random_covariance(random, 6);
    const int row = static_cast<int>(random.below(6)), column = static_cast<int>(random.below(6));
    const double deviations = sqrt(C(row, row)) * sqrt(C(column, column));
    C(row, column) -= (row == column ? 1.5 : 2.5) * deviations;
    EXPECT_FALSE(is_covariance(C));
    const Matrix6 before = C;
    EXPECT_TRUE(make_covariance(C));
    EXPECT_TRUE(is_covariance(C)) << C;
    EXPECT_EQ(C, C.transpose().eval());
    if (row == column) {
      EXPECT_EQ(C(row, row), 0) << "a variance that came out negative";
    }
    for (int k = 0; k < 6; ++k)
      if (k != row && k != column) {
        EXPECT_NEAR(C(k, k), before(k, k), 3 * before(k, k));
      }
    // Once more changes nothing.
    const Matrix6 once = C;
    EXPECT_TRUE(make_covariance(C));
    EXPECT_EQ(C, once);
  }
}

TEST(Covariance, BoundsVariancesAndKeepsCorrelations) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    Matrix6 C = random_covariance(random, 6) * 1e12;
    const Matrix6 before = C;
    Vector6 scale;
    EXPECT_TRUE(make_bounded_covariance(C, &scale));
    EXPECT_TRUE(test::is_sound_covariance(C)) << C;
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < 6; ++b)
        EXPECT_NEAR(C(a, b), before(a, b) * scale[a] * scale[b], 1e-12 * sqrt(C(a, a)) * sqrt(C(b, b)));
  }
}

TEST(Covariance, RefusesMatricesThatAreNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Matrix6 C = Matrix6::Identity();
    C(2, 4) = bad;
    EXPECT_FALSE(is_covariance(C));
    EXPECT_FALSE(make_covariance(C));
    EXPECT_FALSE(make_bounded_covariance(C));
    C = Matrix6::Identity();
    C(0, 0) = bad;
    EXPECT_TRUE(may_be_anywhere(C));
  }
}

// What a robot does with the covariance of its pose: to the camera's lever arm, to another frame, and back.
TEST(Covariance, StaysValidWhereACallerMovesIt) {
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    const Se3 lever{rotation_exp({0.3, -0.2, 0.1}), Vector3(random.uniform(), random.uniform(), 1)};
    const Se3 frame{rotation_exp({-1, 0.4, 2}), 100 * Vector3(random.uniform(), random.uniform(), 0)};
    Matrix6 C = random_covariance(random, 1 + i % 6);
    for (int k = 0; k < 6; ++k) C(k, k) += 1e-12;  // a micrometre, a microradian
    C = compose_covariance(frame, Matrix6::Zero(), lever, C);
    EXPECT_TRUE(is_covariance(C)) << C;
    C = compose_covariance(Se3{}, C, {lever.R, -lever.t}, Matrix6::Zero());
    EXPECT_TRUE(is_covariance(C)) << C;
  }
}

// A lever arm of a kilometre, taken and given back: the position's variance is all but cancelled.
TEST(Covariance, StaysValidAfterAReversedLeverArm) {
  Random random(4);
  int spoilt = 0;
  for (int i = 0; i < 100; ++i) {
    const Se3 far{rotation_exp({0.3, -0.2, 0.1}), 1000 * Vector3(random.uniform(), random.uniform(), 1)};
    const Matrix6 before = random_covariance(random, 3);
    const Matrix6 there = compose_covariance(Se3{}, before, far, Matrix6::Zero());
    Matrix6 back = compose_covariance(Se3{}, there, {far.R, -far.t}, Matrix6::Zero());
    spoilt += test::is_sound_covariance(back) ? 0 : 1;
    EXPECT_TRUE(make_bounded_covariance(back));
    EXPECT_TRUE(test::is_sound_covariance(back)) << back;
  }
  EXPECT_GT(spoilt, 0) << "else this tests nothing";
}

// Compared with Eigen's determinant, also after the covariance was moved to another point.
TEST(Covariance, GeneralisedVarianceIsTheDeterminant) {
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    Matrix6 A;  // of millimetres and milliradians
    for (int k = 0; k < 36; ++k) A(k) = 1e-3 * random.uniform();
    const Matrix6 C = A * A.transpose() + 1e-8 * Matrix6::Identity();
    const double det = C.determinant();
    EXPECT_NEAR(generalised_variance(C), det, 1e-9 * det);
    const Se3 lever{rotation_exp({0.3, -0.2, 0.1}), Vector3(random.uniform(), random.uniform(), 1)};
    EXPECT_NEAR(generalised_variance(compose_covariance(Se3{}, C, lever, Matrix6::Zero())), det, 1e-6 * det);
  }
  EXPECT_EQ(generalised_variance(Matrix6::Zero()), 0);
  Matrix6 singular = Matrix6::Identity();
  singular(0, 1) = singular(1, 0) = 1;
  EXPECT_EQ(generalised_variance(singular), std::numeric_limits<double>::infinity());
}

// A position is not compared with an orientation.
TEST(Covariance, ExceedsBoundsOfPositionOrOrientation) {
  Matrix6 C = Matrix6::Zero();
  C.diagonal() << 0.1, 0.2, 0.3, 0.01, 0.02, 0.03;
  EXPECT_FALSE(exceeds(C, {.position_m2 = 0.61, .orientation_rad2 = 0.061}));
  EXPECT_TRUE(exceeds(C, {.position_m2 = 0.59, .orientation_rad2 = 10}));
  EXPECT_TRUE(exceeds(C, {.position_m2 = 10, .orientation_rad2 = 0.059}));
  C(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(exceeds(C, {.position_m2 = 10, .orientation_rad2 = 10}));
}

}  // namespace
}  // namespace plvo
