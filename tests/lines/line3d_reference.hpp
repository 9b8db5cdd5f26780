// SPDX-License-Identifier: Apache-2.0
// A slow reference implementation of L3: equations (5)–(10) in three dimensions, with 3×3 covariances,
// numerical Jacobians and dense Gauss–Newton over the six numbers [A, B].
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "dense.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/lines/line3d.hpp"

namespace plvo::reference {

// Equation (5), minimised over λ on ever finer grids.
inline double mahalanobis_by_search(const Point3d& point, const Vector3& a, const Vector3& b) {
  const Matrix3 information = point.Sigma.inverse();
  const auto value = [&](double lambda) {
    const Vector3 e = point.p - (a + lambda * (b - a));
    return e.dot(information * e);
  };
  double centre = 0.5, half = 20;
  for (int level = 0; level < 60; ++level) {
    double best = centre;
    for (int i = -10; i <= 10; ++i)
      if (value(centre + half * i / 10) < value(best)) best = centre + half * i / 10;
    centre = best;
    half *= 0.5;
  }
  return std::sqrt(value(centre));
}

// Equation (6).
inline Vector3 delta(const Point3d& point, const Vector3& a, const Vector3& b) {
  const Matrix3 information = point.Sigma.inverse();
  const Vector3 d = b - a, e = a - point.p;
  return point.p - (a - d.dot(information * e) / d.dot(information * d) * d);
}

// Equation (8), whitened by Σ_w.
inline test::DenseVector whitened_w(const std::vector<Point3d>& points, const Vector6& L) {
  const Vector3 a = L.head<3>(), b = L.tail<3>();
  test::DenseVector w(3 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vector3 e = delta(points[i], a, b);
    if (i == 0) e = points[i].p - a;
    if (i + 1 == points.size()) e = points[i].p - b;
    w.segment<3>(3 * static_cast<Eigen::Index>(i)) = points[i].Sigma.llt().matrixL().solve(e);
  }
  return w;
}

inline test::Dense jacobian(const std::vector<Point3d>& points, const Vector6& L) {
  test::Dense J(3 * points.size(), 6);
  for (int k = 0; k < 6; ++k) {
    Vector6 plus = L, minus = L;
    plus(k) += 1e-5;
    minus(k) -= 1e-5;
    J.col(k) = (whitened_w(points, plus) - whitened_w(points, minus)) / 2e-5;
  }
  return J;
}

struct Mle {
  Vector6 L;
  Matrix6 covariance;
  double cost = 0;
};

// Equations (9) and (10) by damped Gauss–Newton, starting from the first and the last point.
inline Mle maximum_likelihood(const std::vector<Point3d>& points) {
  Mle mle;
  mle.L << points.front().p, points.back().p;
  double damping = 1e-3;
  for (int i = 0; i < 100; ++i) {
    const test::DenseVector w = whitened_w(points, mle.L);
    const test::Dense J = jacobian(points, mle.L);
    Matrix6 H = test::transposed_product(J, J);
    H.diagonal() *= 1 + damping;
    const Vector6 moved = mle.L - test::solve_positive(H, test::transposed_product(J, w));
    if (whitened_w(points, moved).squaredNorm() <= w.squaredNorm()) {
      mle.L = moved;
      damping *= 0.1;
    } else {
      damping *= 10;
    }
  }
  const test::Dense J = jacobian(points, mle.L);
  mle.covariance = test::inverse(test::transposed_product(J, J));
  mle.cost = whitened_w(points, mle.L).squaredNorm();
  return mle;
}

}  // namespace plvo::reference
