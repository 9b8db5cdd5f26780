// SPDX-License-Identifier: Apache-2.0
#include "plvo/math/absolute_orientation.hpp"

#include "plvo/math/se3.hpp"
#include "plvo/math/symmetric_eigen.hpp"

namespace plvo {

Matrix3 best_rotation(const Matrix3& correlation) {
  // Horn's matrix N for quaternions (x, y, z, w): the sum of bᵀ R(q) a over the pairs equals qᵀ N q.
  const Matrix3& S = correlation;
  Matrix4 N;
  N.block<3, 3>(0, 0) = S + S.transpose();
  for (int i = 0; i < 3; ++i) N(i, i) -= S.trace();
  N(3, 0) = S(2, 1) - S(1, 2);
  N(3, 1) = S(0, 2) - S(2, 0);
  N(3, 2) = S(1, 0) - S(0, 1);
  N(3, 3) = S.trace();
  const SymmetricEigen<4> eigen = symmetric_eigen<4>(N);
  int best = 0;
  for (int k = 1; k < 4; ++k)
    if (eigen.values[k] > eigen.values[best]) best = k;
  const Vector4 q = eigen.vectors.col(best);
  return to_rotation({q[0], q[1], q[2], q[3]});
}

}  // namespace plvo
