// SPDX-License-Identifier: Apache-2.0
// Cholesky factor A = L Lᵀ of a small symmetric positive definite matrix, in one fixed order of operations,
// on the stack. Only the lower triangle of A is read.
#pragma once

#include "plvo/math/matrix_size.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

// The algorithms, over n × n entries column by column; reciprocal holds 1 / L(i, i). No two arrays overlap.
namespace cholesky {

// A pivot at or below this fraction of its diagonal entry counts as zero: the entry has lost its last digits.
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

// x: b before, x after, with L x = b.
template <typename T, typename Size>
inline void solve_lower(const double* __restrict L, const double* __restrict reciprocal, Size n,
                        T* __restrict x) {
  for (int i = 0; i < n; ++i) {
    T sum = x[i];
    for (int k = 0; k < i; ++k) sum -= L[i + k * n] * x[k];
    x[i] = sum * reciprocal[i];
  }
}

// … with Lᵀ x = b.
template <typename Size>
inline void solve_upper(const double* __restrict L, const double* __restrict reciprocal, Size n,
                        double* __restrict x) {
  for (int i = n - 1; i >= 0; --i) {
    double sum = x[i];
    for (int k = i + 1; k < n; ++k) sum -= L[k + i * n] * x[k];
    x[i] = sum * reciprocal[i];
  }
}

// M: scratch.
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
  // False when A is not numerically positive definite, or holds a NaN or an infinity; then nothing else may
  // be called.
  bool factor(const Matrix<N, N>& A) { return cholesky::factor(A.data(), kN, L_.data(), reciprocal_.data()); }

  // x with L x = b: "whitens" b when A is its covariance, |x|² = bᵀ A⁻¹ b.
  Vector<N> solve_lower(Vector<N> b) const {
    cholesky::solve_lower(L_.data(), reciprocal_.data(), kN, b.data());
    return b;
  }

  // The same in place, for N numbers of a type that doubles multiply: Pair solves for two at once.
  template <typename T>
  void solve_lower(T (&x)[N]) const {
    cholesky::solve_lower(L_.data(), reciprocal_.data(), kN, &x[0]);
  }

  // x with A x = b.
  Vector<N> solve(const Vector<N>& b) const {
    Vector<N> x = solve_lower(b);
    cholesky::solve_upper(L_.data(), reciprocal_.data(), kN, x.data());
    return x;
  }

  // A⁻¹, exactly symmetric.
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
