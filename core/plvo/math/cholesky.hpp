// SPDX-License-Identifier: Apache-2.0
// Cholesky factorisation A = L Lᵀ of a small symmetric positive definite matrix, on the stack and in a fixed
// order of operations. It reads only the lower triangle of A.
#pragma once

#include "plvo/math/matrix_size.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

// The algorithms. Matrices are n × n in column-major order; reciprocal holds 1 / L(i, i). No two arrays may
// overlap.
namespace cholesky {

// A pivot at or below this fraction of its diagonal entry counts as zero, because cancellation has left no
// significant digits.
inline constexpr double kRelativePivot = 1e-14;

template <typename Size>
inline bool factor(const double* __restrict A, Size n, double* __restrict L, double* __restrict reciprocal) {
  for (int j = 0; j < n; ++j) {
    double pivot = A[j + j * n];
    for (int k = 0; k < j; ++k) pivot -= L[j + k * n] * L[j + k * n];
    if (!(pivot > kRelativePivot * A[j + j * n]) || !(pivot < 1e300)) return false;
    L[j + j * n] = sqrt(pivot);
    reciprocal[j] = 1 / L[j + j * n];
    for (int i = j + 1; i < n; ++i) {
      double sum = A[i + j * n];
      for (int k = 0; k < j; ++k) sum -= L[i + k * n] * L[j + k * n];
      L[i + j * n] = sum * reciprocal[j];
    }
  }
  return true;
}

// Solves L x' = x in place: x is the right-hand side before the call and the solution after it.
template <typename T, typename Size>
inline void solve_lower(const double* __restrict L, const double* __restrict reciprocal, Size n,
                        T* __restrict x) {
  for (int i = 0; i < n; ++i) {
    T sum = x[i];
    for (int k = 0; k < i; ++k) sum -= L[i + k * n] * x[k];
    x[i] = sum * reciprocal[i];
  }
}

// Solves Lᵀ x' = x in place.
template <typename Size>
inline void solve_upper(const double* __restrict L, const double* __restrict reciprocal, Size n,
                        double* __restrict x) {
  for (int i = n - 1; i >= 0; --i) {
    double sum = x[i];
    for (int k = i + 1; k < n; ++k) sum -= L[k + i * n] * x[k];
    x[i] = sum * reciprocal[i];
  }
}

// Writes A⁻¹ to inverse. M is scratch of n × n entries.
template <typename Size>
inline void invert(const double* __restrict L, const double* __restrict reciprocal, Size n,
                   double* __restrict M, double* __restrict inverse) {
  for (int j = 0; j < n; ++j) {  // L⁻¹, lower triangle
    M[j + j * n] = reciprocal[j];
    for (int i = j + 1; i < n; ++i) {
      double sum = 0;
      for (int k = j; k < i; ++k) sum -= L[i + k * n] * M[k + j * n];
      M[i + j * n] = sum * reciprocal[i];
    }
  }
  for (int i = 0; i < n; ++i)  // L⁻ᵀ L⁻¹
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (int k = i; k < n; ++k) sum += M[k + i * n] * M[k + j * n];
      inverse[i + j * n] = sum;
      inverse[j + i * n] = sum;
    }
}

}  // namespace cholesky

template <int N>
class Cholesky {
 public:
  // Returns false if A is not numerically positive definite or contains a NaN or an infinity. In that case
  // the other functions must not be called.
  bool factor(const Matrix<N, N>& A) { return cholesky::factor(A.data(), kN, L_.data(), reciprocal_.data()); }

  // Returns x with L x = b. If A is the covariance of b, this whitens b: |x|² = bᵀ A⁻¹ b.
  Vector<N> solve_lower(Vector<N> b) const {
    cholesky::solve_lower(L_.data(), reciprocal_.data(), kN, b.data());
    return b;
  }

  // The same in place, for N numbers of any type that can be multiplied by a double. Pair solves for two
  // right-hand sides at once.
  template <typename T>
  void solve_lower(T (&x)[N]) const {
    cholesky::solve_lower(L_.data(), reciprocal_.data(), kN, &x[0]);
  }

  // Returns x with A x = b.
  Vector<N> solve(const Vector<N>& b) const {
    Vector<N> x = solve_lower(b);
    cholesky::solve_upper(L_.data(), reciprocal_.data(), kN, x.data());
    return x;
  }

  // Returns A⁻¹, exactly symmetric.
  Matrix<N, N> inverse() const {
    Matrix<N, N> M, inverse;
    cholesky::invert(L_.data(), reciprocal_.data(), kN, M.data(), inverse.data());
    return inverse;
  }

 private:
  static constexpr auto kN = matrix_size<N>();

  Matrix<N, N> L_;
  Vector<N> reciprocal_;  // 1 / L(i, i)
};

}  // namespace plvo
