// SPDX-License-Identifier: Apache-2.0
// Eigenvalues and eigenvectors of a small symmetric matrix by cyclic Jacobi rotations (Golub & Van Loan,
// "Matrix Computations", 4th ed., algorithm 8.5.3): fixed order, bounded sweeps, every eigenvalue accurate to
// rounding.
#pragma once

#include "plvo/math/trigonometry.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

template <int N>
struct SymmetricEigen {
  Vector<N> values;      // unordered
  Matrix<N, N> vectors;  // column k belongs to values[k]; orthonormal
};

// A must be finite; only its lower triangle is read. Quadratic convergence makes 4 to 6 sweeps the rule; the
// bound of 12 is never reached by a finite matrix of these sizes.
template <int N>
SymmetricEigen<N> symmetric_eigen(const Matrix<N, N>& matrix) {
  constexpr int kMaxSweeps = 12;
  SymmetricEigen<N> result;
  Matrix<N, N> A = matrix.template selfadjointView<Eigen::Lower>();
  Matrix<N, N>& V = result.vectors;
  V.setIdentity();
  const double tiny = 1e-32 * A.squaredNorm();
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double off_diagonal = 0;
    for (int p = 0; p < N; ++p)
      for (int q = p + 1; q < N; ++q) off_diagonal += A(p, q) * A(p, q);
    if (!(off_diagonal > tiny)) break;
    for (int p = 0; p < N; ++p)
      for (int q = p + 1; q < N; ++q) {
        if (A(p, q) == 0) continue;
        // The smaller of the two angles that annihilate A(p, q).
        const double tau = (A(q, q) - A(p, p)) / (2 * A(p, q));
        const double t = (tau >= 0 ? 1 : -1) / ((tau >= 0 ? tau : -tau) + sqrt(1 + tau * tau));
        const double c = 1 / sqrt(1 + t * t);
        const double s = t * c;
        for (int k = 0; k < N; ++k) {
          const double a = A(k, p);
          const double b = A(k, q);
          A(k, p) = c * a - s * b;
          A(k, q) = s * a + c * b;
        }
        for (int k = 0; k < N; ++k) {
          const double a = A(p, k);
          const double b = A(q, k);
          A(p, k) = c * a - s * b;
          A(q, k) = s * a + c * b;
        }
        for (int k = 0; k < N; ++k) {
          const double a = V(k, p);
          const double b = V(k, q);
          V(k, p) = c * a - s * b;
          V(k, q) = s * a + c * b;
        }
      }
  }
  result.values = A.diagonal();
  return result;
}

}  // namespace plvo
