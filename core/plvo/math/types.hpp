// SPDX-License-Identifier: Apache-2.0
// The matrix types of plvo. DontAlign makes their layout independent of the vector flags of the user's
// program. Eigen's own alignment depends on these flags and would break the ABI.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace plvo {

template <int Rows, int Cols>
using Matrix =
    Eigen::Matrix<double, Rows, Cols, Eigen::DontAlign | (Rows == 1 && Cols != 1 ? Eigen::RowMajor : 0)>;
template <int Rows>
using Vector = Matrix<Rows, 1>;

using Vector2 = Vector<2>;
using Vector3 = Vector<3>;
using Vector4 = Vector<4>;
using Vector6 = Vector<6>;
using Matrix2 = Matrix<2, 2>;
using Matrix3 = Matrix<3, 3>;
using Matrix4 = Matrix<4, 4>;
using Matrix6 = Matrix<6, 6>;

// (M + Mᵀ) / 2, which removes the rounding of a product that is symmetric.
template <int N>
Matrix<N, N> symmetric(const Matrix<N, N>& M) {
  return 0.5 * (M + Matrix<N, N>(M.transpose()));
}

constexpr bool is_finite(double x) { return x - x == 0; }

}  // namespace plvo
