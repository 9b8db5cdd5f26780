// SPDX-License-Identifier: Apache-2.0
// Matrices of C, which are row-major arrays, as the library's, and back.
#pragma once

#include "plvo/math/se3.hpp"

namespace plvo::c {

template <int Size>
Matrix<Size, Size> matrix(const double* values) {
  Matrix<Size, Size> result;
  for (int row = 0; row < Size; ++row)
    for (int column = 0; column < Size; ++column) result(row, column) = values[Size * row + column];
  return result;
}

inline Vector3 vector3(const double* values) { return {values[0], values[1], values[2]}; }

// The 3×4 matrix [R t].
inline Se3 se3(const double* values) {
  Se3 T;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) T.R(row, column) = values[4 * row + column];
    T.t(row) = values[4 * row + 3];
  }
  return T;
}

template <int Rows, int Columns>
void put(const Matrix<Rows, Columns>& matrix, double (&out)[Rows * Columns]) {
  for (int row = 0; row < Rows; ++row)
    for (int column = 0; column < Columns; ++column) out[Columns * row + column] = matrix(row, column);
}

inline void put(const Se3& T, double (&out)[12]) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out[4 * row + column] = T.R(row, column);
    out[4 * row + 3] = T.t(row);
  }
}

}  // namespace plvo::c
