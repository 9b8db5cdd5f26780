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

// Diagonalises the n × n matrix A in place. V must be the identity before the call and holds the eigenvectors
// after it. Convergence is quadratic, so 4 to 6 sweeps usually suffice. A finite matrix of these sizes never
// reaches the limit of 12.
template <typename Size>
inline void diagonalise(double* A, double* V, Size n, double tiny) {
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
  Matrix<N, N> A = matrix.template selfadjointView<Eigen::Lower>();
  result.vectors.setIdentity();
  // By columns, because Eigen sums a large matrix in a loop in the size-optimised build
  // (PLVO_SIZE_DEFINITIONS).
  double squared_norm = 0;
  for (int j = 0; j < N; ++j) squared_norm += A.col(j).squaredNorm();
  diagonalise(A.data(), result.vectors.data(), matrix_size<N>(), 1e-32 * squared_norm);
  result.values = A.diagonal();
  return result;
}

}  // namespace plvo
