// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/common_mode_error.hpp"

#include <gtest/gtest.h>

#include <random>

#include "dense.hpp"

namespace plvo {
namespace {

// A covariance of a motion, with smaller variances of the rotation than of the translation.
Matrix6 some_covariance(std::mt19937_64& random, double sigma) {
  std::normal_distribution<double> normal;
  Matrix6 root;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) root(i, j) = sigma * (i < 3 ? 1 : 0.3) * normal(random);
  return root * root.transpose() + 0.05 * sigma * sigma * Matrix6::Identity();
}

// Least and largest of xᵀ A x / xᵀ B x.
Vector2 ratios(const Matrix6& A, const Matrix6& B) {
  const test::Dense L = test::cholesky(B);
  const test::Dense half = test::solve_lower(L, A);
  const test::DenseVector values = test::symmetric_eigenvalues(test::solve_lower(L, half.transpose()));
  return {values.minCoeff(), values.maxCoeff()};
}

ReferenceInformation inverses(const Matrix6& base, const Matrix6& others) {
  return {test::inverse(base), test::inverse(others)};
}

// What is said of the motion, C + D and C alone, as shares of what is true: least and largest of all
// directions.
struct Said {
  Vector2 with, without;
};

// Frames that are matched with a keyframe and with the frame before. The matches with the keyframe have the
// error a + v. Those with the frame before have the error q in addition to that of the frame's pose. a is the
// same for all frames; v and q are independent. The weights of the estimate assume that all are independent.
// The covariance of the resulting error e, jointly with a, follows exactly from frame to frame.
Said after(int frames, double share, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const Matrix6 R = some_covariance(random, 0.01), Q = some_covariance(random, 0.003);
  Matrix6 C = R, D = Matrix6::Zero();        // as the odometry has it
  Matrix6 of_e = R, of_e_and_a = share * R;  // E[e eᵀ], E[e aᵀ]
  for (int i = 1; i < frames; ++i) {
    const ReferenceInformation information = inverses(R, C + Q);
    D = common_mode_error(information, D, share);
    C = test::inverse(information.base + information.others);
    const Matrix6 K = C * information.others, L = Matrix6::Identity() - K;
    const Matrix6 both = L * of_e_and_a.transpose() * K.transpose();
    of_e = (L * R * L.transpose() + K * (of_e + Q) * K.transpose() + both + both.transpose()).eval();
    of_e_and_a = (L * (share * R) + K * of_e_and_a).eval();
  }
  return {ratios(C + D, of_e), ratios(C, of_e)};
}

TEST(CommonModeError, EqualsTheMissingCovarianceOfALinearModel) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const double share : {0.0, 0.3, 0.6, 1.0})
      for (const int frames : {2, 10, 100}) {
        const Said said = after(frames, share, seed);
        EXPECT_NEAR(said.with[0], 1, 1e-9) << "share " << share << ", frames " << frames << ", seed " << seed;
        EXPECT_NEAR(said.with[1], 1, 1e-9) << "share " << share << ", frames " << frames << ", seed " << seed;
        if (share > 0 && frames == 100) {
          EXPECT_LT(said.without[0], 0.4);
        }
      }
}

TEST(CommonModeError, IsZeroWithoutOtherReferencesAndKeptWithoutABase) {
  std::mt19937_64 random(3);
  const Matrix6 H = test::inverse(some_covariance(random, 0.01)), D = some_covariance(random, 0.02);
  EXPECT_LT(common_mode_error({H, Matrix6::Zero()}, D, 0.6).norm(), 1e-12 * D.norm());
  EXPECT_LT((common_mode_error({Matrix6::Zero(), H}, D, 0.6) - D).norm(), 1e-6 * D.norm());
  EXPECT_EQ(common_mode_error({Matrix6::Zero(), Matrix6::Zero()}, D, 0.6), Matrix6::Zero());
}

// The keyframe goes out of view: the two errors cannot be more alike than both being one.
TEST(CommonModeError, IsAtMostThatOfFullyCorrelatedErrors) {
  std::mt19937_64 random(5);
  for (const double grown : {1.0, 10.0, 1e4}) {
    const Matrix6 R = grown * some_covariance(random, 0.01), S = some_covariance(random, 0.003);
    const Matrix6 D = some_covariance(random, 0.003);
    const ReferenceInformation information = inverses(R, S);
    const Matrix6 C = test::inverse(information.base + information.others);
    const Matrix6 K = C * information.others, L = Matrix6::Identity() - K;
    const Matrix6 said = C + common_mode_error(information, D, 1);
    const Matrix6 apart = L * R * L.transpose() + K * (S + D) * K.transpose();
    EXPECT_GE(ratios(said, apart)[0], 1 - 1e-9) << grown;
    // In units of J⁻¹, all directions together.
    const Matrix6 J = information.base + information.others;
    EXPECT_LE(J.cwiseProduct(said).sum(), (2 + 1e-9) * J.cwiseProduct(apart).sum()) << grown;
  }
}

}  // namespace
}  // namespace plvo
