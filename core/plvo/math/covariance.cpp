// SPDX-License-Identifier: Apache-2.0
#include "plvo/math/covariance.hpp"

#include <algorithm>
#include <limits>

#include "plvo/math/cholesky.hpp"
#include "plvo/math/symmetric_eigen.hpp"

namespace plvo {
namespace {

// Inverse standard deviations; 0 for a variance that is not positive.
Vector6 inverse_deviations(const Matrix6& C) {
  Vector6 inverse;
  for (int i = 0; i < 6; ++i) inverse[i] = C(i, i) > 0 ? 1 / sqrt(C(i, i)) : 0;
  return inverse;
}

// Correlation matrix; an entry without variance has 1 with itself and 0 with the others.
Matrix6 correlations(const Matrix6& C, const Vector6& inverse) {
  Matrix6 unit;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      unit(i, j) =
          i == j ? 1.0 : 0.5 * (C(i, j) * inverse[i] * inverse[j] + C(j, i) * inverse[i] * inverse[j]);
  return unit;
}

// Not inlined: its matrices would otherwise be on the stack of callers whose covariance needs no repair.
[[gnu::noinline]] void repair(Matrix6& C) {
  const Vector6 inverse = inverse_deviations(C);
  const Matrix6 unit = correlations(C, inverse);
  // A unit diagonal bounds the correlations: entries beyond ±1 come from a variance that is pure rounding.
  const SymmetricEigen<6> eigen = symmetric_eigen<6>(unit.cwiseMax(-1).cwiseMin(1));
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (int k = 0; k < 6; ++k)
        sum += std::max(eigen.values[k], 0.0) * eigen.vectors(i, k) * eigen.vectors(j, k);
      const double entry = inverse[i] > 0 && inverse[j] > 0 ? sum / (inverse[i] * inverse[j]) : 0;
      C(i, j) = C(j, i) = entry;
    }
}

}  // namespace

double generalised_variance(const Matrix6& C) {
  Matrix6 L;
  Vector6 reciprocal;
  if (!cholesky::factor(C.data(), matrix_size<6>(), L.data(), reciprocal.data()))
    return C.isZero(0) ? 0 : std::numeric_limits<double>::infinity();
  double det = 1;
  for (int i = 0; i < 6; ++i) det *= L(i, i) * L(i, i);
  return det;
}

bool is_covariance(const Matrix3& C) {
  Matrix6 with_zeros = Matrix6::Zero();
  with_zeros.block<3, 3>(0, 0) = C;
  return is_covariance(with_zeros);
}

bool is_covariance(const Matrix6& C) {
  if (!C.allFinite() || !(C.diagonal().minCoeff() >= 0)) return false;
  const Vector6 inverse = inverse_deviations(C);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < i; ++j) {
      const bool unsure = inverse[i] > 0 && inverse[j] > 0;
      if (!unsure && (C(i, j) != 0 || C(j, i) != 0)) return false;
      const double apart = C(i, j) - C(j, i);
      if (unsure && !((apart < 0 ? -apart : apart) * inverse[i] * inverse[j] <= kCovarianceTolerance))
        return false;
    }
  Matrix6 unit = correlations(C, inverse);
  unit.diagonal().array() += kCovarianceTolerance;
  Cholesky<6> cholesky;
  return cholesky.factor(unit);
}

bool make_covariance(Matrix6& C) {
  if (is_covariance(C)) return true;
  if (!C.allFinite()) return false;
  repair(C);
  return C.allFinite();
}

bool make_bounded_covariance(Matrix6& C, Vector6* scale) {
  if (!C.allFinite()) return false;
  Vector6 factors = Vector6::Ones();
  for (int i = 0; i < 6; ++i) {
    const double most = i < 3 ? kMostPositionVariance : kMostRotationVariance;
    if (!(C(i, i) > most)) continue;
    factors[i] = sqrt(most / C(i, i));
    C.row(i) *= factors[i];
    C.col(i) *= factors[i];
  }
  if (scale != nullptr) *scale = factors;
  return make_covariance(C);
}

}  // namespace plvo
