// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/common_mode_error.hpp"

#include <algorithm>

#include "plvo/math/cholesky.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/math/symmetric_eigen.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {

Matrix6 common_mode_error(const ReferenceInformation& information, const Matrix6& D, double share) {
  const Matrix6 J = information.base + information.others;
  Cholesky<6> cholesky;
  if (!cholesky.factor(J)) return Matrix6::Zero();
  Matrix6 whiten;  // L⁻¹, J = L Lᵀ
  for (int i = 0; i < 6; ++i) whiten.col(i) = cholesky.solve_lower(Vector6::Unit(i));
  const Matrix6 others = transform_covariance(whiten, information.others);
  const SymmetricEigen<6> eigen = symmetric_eigen<6>(others);
  const Matrix6 T = whiten.transpose().lazyProduct(eigen.vectors);
  const Matrix6 T_inverse = T.transpose().lazyProduct(J);
  Matrix6 d = transform_covariance(T_inverse, D);
  Vector6 k, added;
  for (int i = 0; i < 6; ++i) {
    k[i] = std::clamp(eigen.values[i], 0.0, 1.0);
    const double bound = share * (1 - k[i]) * (1 + k[i] * d(i, i));  // k s share (1 − k)
    added[i] = 2 * std::min(k[i] * share, sqrt(std::max(0.0, k[i] * bound)));
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) d(i, j) = k[i] * d(i, j) * k[j] + (i == j ? added[i] : 0);
  return symmetric<6>(transform_covariance(T, d));
}

}  // namespace plvo
