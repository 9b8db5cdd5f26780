// SPDX-License-Identifier: Apache-2.0
// The few matrix types of plvo. DontAlign keeps their layout the same whatever vector flags a user's own
// program is compiled with: Eigen's alignment would otherwise change with them and break the ABI.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

// In plvo's own files alone (tools/cmake/plvo.cmake): a user's Eigen stays as it is.
#ifdef PLVO_ROLLED_LOOPS
#include "plvo/math/rolled_loops.hpp"
#endif
#ifdef PLVO_SIZE_OPTIMISED
#include "plvo/math/one_product.hpp"
#include "plvo/math/written_entries.hpp"
#endif

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

// Eigen leaves the entries of a matrix without an initialiser as they were.
template <std::size_t Count>
std::array<Matrix6, Count> zero_matrices() {
  std::array<Matrix6, Count> matrices;
  for (Matrix6& matrix : matrices) matrix.setZero();
  return matrices;
}

constexpr bool is_finite(double x) { return x - x == 0; }

}  // namespace plvo
