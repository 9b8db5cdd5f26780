// SPDX-License-Identifier: Apache-2.0
// A reference whose pose is known with a covariance, against a dense normal matrix in which that pose has
// parameters of its own, and the gradient against the cost.
#include <gtest/gtest.h>

#include <cstdio>

#include "numeric_jacobian.hpp"
#include "two_references.hpp"

namespace plvo {
namespace {

using test::difference;
using test::Gaussian;
using test::kAway;
using test::Linearization;
using test::linearize;
using test::SimulatedPair;
using test::TwoReferences;

// Positive definite, of a few millimetres and milliradians, everything correlated.
Matrix6 some_covariance(std::uint64_t seed) {
  Gaussian gaussian(seed);
  Matrix6 A;
  for (int j = 0; j < 6; ++j) A.col(j) = gaussian.vector<6>();
  return 4e-6 * (A * A.transpose() + 0.1 * Matrix6::Identity());
}

// The points of reference 1 with the motion ξ and the perturbation η of T_1_0 as parameters, twelve in all:
// normal matrix, gradient and cost of the residuals P' − T X* at fixed landmarks X*, and the prior of η.
// Derivatives are numeric.
struct DenseTwelve {
  DenseTwelve(const TwoReferences& two, const Se3& T, const Matrix6& C) {
    const SimulatedPair& pair = two.pairs[1];
    const auto motion = [&](const Vector<12>& parameters) {
      return boxplus(T, parameters.head<6>()) * boxplus(two.T_1_0, parameters.tail<6>()).inverse();
    };
    const Se3 T_c_1 = motion(Vector<12>::Zero());
    for (std::size_t i = 0; i < pair.points_reference.size(); ++i) {
      const Point3d& reference = pair.points_reference[i];
      const Point3d& current = pair.points_current[i];
      const Matrix3 W = Matrix3(T_c_1.R * reference.Sigma * T_c_1.R.transpose() + current.Sigma).inverse();
      const Vector3 e = current.p - T_c_1 * reference.p;
      const Vector3 landmark = T_c_1.inverse() * Vector3(current.p - current.Sigma * (W * e));
      const Matrix<3, 12> J = numeric_jacobian<3, 12>(
          [&](const Vector<12>& parameters) { return Vector3(current.p - motion(parameters) * landmark); },
          Vector<12>::Zero(), 1e-5);
      N += J.transpose() * W * J;
      g += J.transpose() * W * e;
      cost += 0.5 * e.dot(W * e);
    }
    N.bottomRightCorner<6, 6>() += test::inverse(C);
    // The same perturbation of T_current_1 that the prior's is worth, by numeric derivatives.
    A = numeric_jacobian<6, 6>(
        [&](const Vector6& xi) {
          Vector<12> parameters = Vector<12>::Zero();
          parameters.head<6>() = xi;
          return boxminus(motion(parameters), T_c_1);
        },
        Vector6::Zero(), 1e-5);
    B = numeric_jacobian<6, 6>(
        [&](const Vector6& eta) {
          Vector<12> parameters = Vector<12>::Zero();
          parameters.tail<6>() = eta;
          return boxminus(motion(parameters), T_c_1);
        },
        Vector6::Zero(), 1e-5);
  }
  // η eliminated.
  Linearization on_motion() const {
    const Matrix6 cross = N.bottomLeftCorner<6, 6>();
    const Vector6 of_eta = test::solve_positive(N.bottomRightCorner<6, 6>(), g.tail<6>());
    Linearization out;
    out.H = N.topLeftCorner<6, 6>() -
            test::transposed_product(cross, test::solve_positive(N.bottomRightCorner<6, 6>(), cross));
    out.g = g.head<6>() - cross.transpose() * of_eta;
    out.cost = cost - 0.5 * g.tail<6>().dot(of_eta);
    return out;
  }
  Eigen::Matrix<double, 12, 12> N = Eigen::Matrix<double, 12, 12>::Zero();
  Eigen::Matrix<double, 12, 1> g = Eigen::Matrix<double, 12, 1>::Zero();
  double cost = 0;
  Matrix6 A, B;
};

TEST(TwoReferences, EliminationOfThePoseEqualsADenseProblem) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    TwoReferences two(seed, 40, 0);
    const Matrix6 C = some_covariance(seed);
    two.references[1].covariance = C;
    const auto sets = two.sets_of(two.pairs[0], two.pairs[1], 1);
    const std::span<ConstraintSet* const> first(sets.data(), 2);
    const std::span<ConstraintSet* const> second(sets.data() + 2, 2);
    const Se3 T = boxplus(two.truth, kAway);

    const DenseTwelve dense(two, T, C);
    const Linearization expected = dense.on_motion();
    const Linearization got = linearize(second, two.references, T);
    EXPECT_LT(difference(got.H, expected.H), 1e-5);
    EXPECT_LT(difference(got.g, expected.g, expected.H), 1e-4);
    EXPECT_NEAR(got.cost, expected.cost, 1e-6 * expected.cost);
    // The covariance does take information away, and what is left is (H⁻¹ + B C Bᵀ)⁻¹.
    const Linearization exact = linearize(second, two.references, T, false);
    EXPECT_GT(difference(got.H, exact.H), 0.3);
    const Matrix6 A_inverse = test::inverse(dense.A);
    const Matrix6 H1 = A_inverse.transpose() * exact.H * A_inverse;
    const Matrix6 left = test::inverse(test::inverse(H1) + dense.B * C * dense.B.transpose());
    EXPECT_LT(difference(got.H, dense.A.transpose() * left * dense.A), 1e-5);

    // Reference 0 just adds what it knows.
    const Linearization base = linearize(first, two.references, T);
    const Linearization both = linearize(sets, two.references, T);
    EXPECT_LT(difference(both.H, base.H + expected.H), 1e-5);
    EXPECT_LT(difference(both.g, base.g + expected.g, both.H), 1e-4);
    EXPECT_NEAR(both.cost, base.cost + expected.cost, 1e-6 * both.cost);
  }
}

TEST(TwoReferences, AcceptsASingularCovariance) {
  // Known exactly but for one direction: rank one, which has no inverse and no Cholesky factor of its own.
  TwoReferences two(8, 40, 0);
  const auto sets = two.sets_of(two.pairs[0], two.pairs[1], 1);
  const std::span<ConstraintSet* const> second(sets.data() + 2, 2);
  const Vector6 a = 0.01 * (Vector6() << 0, 0, 0.4, 0.3, -0.2, 0.1).finished();
  two.references[1].covariance = a * a.transpose();
  const Linearization got = linearize(second, two.references, two.truth);
  const DenseTwelve dense(two, two.truth, a * a.transpose() + 1e-13 * Matrix6::Identity());
  EXPECT_LT(difference(got.H, dense.on_motion().H), 1e-3);
}

TEST(TwoReferences, TheGradientIsThatOfTheCost) {
  // Without noise the Gauss–Newton matrix is the Hessian at the truth, so close to it the gradient and the
  // derivative of the returned cost agree ever better.
  TwoReferences two(9, 30, 10, true);
  two.references[1].covariance = some_covariance(9);
  const auto sets = two.sets_of(two.pairs[0], two.pairs[1], 1);
  double before = 0;
  for (double away : {1.0, 0.1, 0.01}) {
    const Se3 T = boxplus(two.truth, Vector6(away * kAway));
    const Linearization at = linearize(sets, two.references, T);
    const Vector6 numeric = numeric_jacobian<1, 6>(
                                [&](const Vector6& step) {
                                  Vector<1> cost;
                                  cost[0] = linearize(sets, two.references, T, true, step).cost;
                                  return cost;
                                },
                                Vector6::Zero(), 1e-3 * away * 1e-3)
                                .transpose();
    const double error = difference(at.g, numeric, at.H) / difference(at.g, Vector6::Zero(), at.H);
    std::printf("away %.2f: gradient off by %.2e of itself\n", away, error);
    if (before > 0) {
      EXPECT_LT(error, 0.2 * before);
    }
    before = error;
  }
  EXPECT_LT(before, 1e-3);
}

}  // namespace
}  // namespace plvo
