// SPDX-License-Identifier: Apache-2.0
// Eigenvalues and eigenvectors of a small symmetric matrix by cyclic Jacobi rotations (Golub & Van Loan,
// "Matrix Computations", 4th ed., algorithm 8.5.3). The order is fixed, the number of sweeps is bounded, and
// every eigenvalue is accurate to rounding.
#pragma once

#include "plvo/math/matrix_size.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

template <int N>
struct SymmetricEigen {
  Vector<N> values;      // unordered
  Matrix<N, N> vectors;  // column k belongs to values[k]; orthonormal
};

// Eigenvalues, the diagonal of A afterwards, and eigenvectors V of the n × n matrix `symmetric`, whose lower
// triangle is read. Convergence is quadratic, so 4 to 6 sweeps usually suffice. A finite matrix of these
// sizes never reaches the limit of 12.
template <typename Size>
inline void diagonalise(const double* symmetric, Size n, double* A, double* V) {
  double squared_norm = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double entry = symmetric[i >= j ? i + j * n : j + i * n];
      A[i + j * n] = entry;
      V[i + j * n] = i == j ? 1 : 0;
      squared_norm += entry * entry;
    }
  const double tiny = 1e-32 * squared_norm;
  constexpr int kMaxSweeps = 12;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double off_diagonal = 0;
    for (int p = 0; p < n; ++p)
      for (int q = p + 1; q < n; ++q) off_diagonal += A[p + q * n] * A[p + q * n];
    if (!(off_diagonal > tiny)) break;
    for (int p = 0; p < n; ++p)
      for (int q = p + 1; q < n; ++q) {
        const double entry = A[p + q * n];
        if (entry == 0) continue;
        // The smaller of the two angles that make A(p, q) zero.
        const double tau = (A[q + q * n] - A[p + p * n]) / (2 * entry);
        const double t = (tau >= 0 ? 1 : -1) / ((tau >= 0 ? tau : -tau) + sqrt(1 + tau * tau));
        const double c = 1 / sqrt(1 + t * t);
        const double s = t * c;
        const auto rotate = [&](double* a, double* b, int step) {
          for (int k = 0; k < n; ++k, a += step, b += step) {
            const double before = *a;
            *a = c * before - s * *b;
            *b = s * before + c * *b;
          }
        };
        rotate(A + p * n, A + q * n, 1);
        rotate(A + p, A + q, n);
        rotate(V + p * n, V + q * n, 1);
      }
  }
}

// A must be finite. Only its lower triangle is read.
template <int N>
SymmetricEigen<N> symmetric_eigen(const Matrix<N, N>& matrix) {
  SymmetricEigen<N> result;
  Matrix<N, N> A;
  diagonalise(matrix.data(), matrix_size<N>(), A.data(), result.vectors.data());
  result.values = A.diagonal();
  return result;
}

}  // namespace plvo
