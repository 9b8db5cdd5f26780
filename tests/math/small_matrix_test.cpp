// SPDX-License-Identifier: Apache-2.0
// Compares eigenvalues, the best rotation and the χ² distribution with Eigen, exact cases and printed tables.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "dense.hpp"
#include "plvo/base/random.hpp"
#include "plvo/math/absolute_orientation.hpp"
#include "plvo/math/chi_square.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/math/symmetric_eigen.hpp"

namespace plvo {
namespace {

template <int N>
Matrix<N, N> random_symmetric(Random& random) {
  Matrix<N, N> A;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j <= i; ++j) A(i, j) = A(j, i) = random.uniform() - 0.5;
  return A;
}

template <int N>
void compare_with_eigen() {
  Random random(61);
  for (int trial = 0; trial < 200; ++trial) {
    Matrix<N, N> A = random_symmetric<N>(random);
    if (trial % 3 == 0) A.col(0) *= 1e4, A.row(0) *= 1e4;  // badly scaled
    const SymmetricEigen<N> ours = symmetric_eigen<N>(A);
    const double scale = A.norm();
    EXPECT_LT((A * ours.vectors - ours.vectors * ours.values.asDiagonal()).norm(), 1e-13 * scale);
    EXPECT_LT((ours.vectors.transpose() * ours.vectors - Matrix<N, N>::Identity()).norm(), 1e-13);
    Vector<N> sorted = ours.values;
    std::sort(sorted.data(), sorted.data() + N);
    EXPECT_LT((sorted - test::symmetric_eigenvalues(A)).norm(), 1e-13 * scale);
  }
}

TEST(SymmetricEigen, AgreesWithEigen) {
  compare_with_eigen<3>();
  compare_with_eigen<4>();
  compare_with_eigen<6>();
}

TEST(SymmetricEigen, IsExactForZeroAndDiagonalMatrices) {
  EXPECT_EQ(symmetric_eigen<3>(Matrix3::Zero()).values, Vector3::Zero());
  EXPECT_EQ(symmetric_eigen<3>(Vector3(3, 1, 2).asDiagonal()).values, Vector3(3, 1, 2));
}

TEST(BestRotation, RecoversTheRotationAndMaximisesTheScore) {
  Random random(62);
  const auto vector = [&] {
    return Vector3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
  };
  for (int trial = 0; trial < 100; ++trial) {
    const Matrix3 R = rotation_exp(6 * vector());
    Matrix3 exact = Matrix3::Zero();
    Matrix3 noisy = Matrix3::Zero();
    for (int i = 0; i < 3; ++i) {
      const Vector3 a = vector();
      exact += R * a * a.transpose();
      noisy += (R * a + 0.1 * vector()) * a.transpose();
    }
    EXPECT_LT((best_rotation(exact) - R).norm(), 1e-9);
    const Matrix3 best = best_rotation(noisy);
    EXPECT_NEAR(best.determinant(), 1, 1e-12);
    const double score = best.cwiseProduct(noisy).sum();
    for (int k = 0; k < 20; ++k)
      EXPECT_GE(score, (rotation_exp(0.2 * vector()) * best).cwiseProduct(noisy).sum() - 1e-12);
  }
}

TEST(BestRotation, NeedsTwoVectorsAndReturnsNoReflection) {
  const Matrix3 R = rotation_exp({0.3, -2.0, 1.0});
  Matrix3 two = Matrix3::Zero();
  for (const Vector3& a : {Vector3(1, 0, 0), Vector3(0, 1, 0)}) two += R * a * a.transpose();
  EXPECT_LT((best_rotation(two) - R).norm(), 1e-12);
  EXPECT_NEAR(best_rotation(Vector3(1, 1, -1).asDiagonal()).determinant(), 1, 1e-12);
}

TEST(ChiSquare, AgreesWithPrintedTables) {
  // Abramowitz & Stegun, table 26.8.
  EXPECT_NEAR(chi_square_quantile(1, 0.95), 3.84146, 5e-6);
  EXPECT_NEAR(chi_square_quantile(2, 0.95), 5.99146, 5e-6);
  EXPECT_NEAR(chi_square_quantile(3, 0.95), 7.81473, 5e-6);
  EXPECT_NEAR(chi_square_quantile(4, 0.95), 9.48773, 5e-6);
  EXPECT_NEAR(chi_square_quantile(3, 0.99), 11.3449, 5e-5);
  EXPECT_NEAR(chi_square_quantile(4, 0.99), 13.2767, 5e-5);
  EXPECT_NEAR(chi_square_quantile(6, 0.99), 16.8119, 5e-5);
  EXPECT_NEAR(chi_square_quantile(3, 0.999), 16.2662, 5e-5);
  EXPECT_NEAR(chi_square_quantile(6, 0.025), 1.237344, 5e-6);
}

TEST(ChiSquare, AgreesWithClosedForms) {
  for (double x = 0; x < 60; x += 0.37) {
    EXPECT_NEAR(chi_square_cdf(1, x), std::erf(std::sqrt(x / 2)), 1e-13);
    EXPECT_NEAR(chi_square_cdf(2, x), 1 - std::exp(-x / 2), 1e-13);
    EXPECT_NEAR(chi_square_cdf(4, x), 1 - std::exp(-x / 2) * (1 + x / 2), 1e-13);
    EXPECT_NEAR(chi_square_cdf(3, x),
                std::erf(std::sqrt(x / 2)) - std::sqrt(2 * x / 3.14159265358979323846) * std::exp(-x / 2),
                1e-13);
  }
}

TEST(ChiSquare, QuantileInvertsTheDistribution) {
  for (int dof = 1; dof <= 12; ++dof)
    for (const double p : {0.001, 0.05, 0.5, 0.9, 0.99, 0.9999, 1 - 1e-9})
      EXPECT_NEAR(chi_square_cdf(dof, chi_square_quantile(dof, p)), p, 1e-8) << dof << ' ' << p;
}

}  // namespace
}  // namespace plvo
