// SPDX-License-Identifier: Apache-2.0
// Tests of errors by their covariance.
#pragma once

#include <limits>

#include "plvo/math/cholesky.hpp"

namespace plvo {

// A true motion passes a test of its six parameters with the probability 0.9999: the squared Mahalanobis
// distance of its error is at most this, the quantile of χ² with six degrees of freedom.
inline constexpr double kMostPlausibleMotion = 27.856341236028712;

// eᵀ C⁻¹ e; infinity where C has no Cholesky factor.
template <int N>
double mahalanobis_squared(const Vector<N>& e, const Matrix<N, N>& C) {
  Cholesky<N> cholesky;
  if (!cholesky.factor(C)) return std::numeric_limits<double>::infinity();
  return cholesky.solve_lower(e).squaredNorm();
}

}  // namespace plvo
