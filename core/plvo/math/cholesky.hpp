// SPDX-License-Identifier: Apache-2.0
// Cholesky factor A = L Lᵀ of a small symmetric positive definite matrix, in one fixed order of operations,
// on the stack. Only the lower triangle of A is read.
#pragma once

#include "plvo/math/trigonometry.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

template <int N>
class Cholesky {
 public:
  // A pivot at or below this fraction of its diagonal entry counts as zero: the entry has lost its last
  // digits.
  static constexpr double kRelativePivot = 1e-14;

  // False when A is not numerically positive definite, or holds a NaN or an infinity; then nothing else may
  // be called.
  bool factor(const Matrix<N, N>& A) {
    for (int j = 0; j < N; ++j) {
      double pivot = A(j, j);
      for (int k = 0; k < j; ++k) pivot -= L_(j, k) * L_(j, k);
      if (!(pivot > kRelativePivot * A(j, j)) || !(pivot < 1e300)) return false;
      L_(j, j) = sqrt(pivot);
      reciprocal_[j] = 1 / L_(j, j);
      for (int i = j + 1; i < N; ++i) {
        double sum = A(i, j);
        for (int k = 0; k < j; ++k) sum -= L_(i, k) * L_(j, k);
        L_(i, j) = sum * reciprocal_[j];
      }
    }
    return true;
  }

  // x with L x = b: "whitens" b when A is its covariance, |x|² = bᵀ A⁻¹ b.
  Vector<N> solve_lower(const Vector<N>& b) const {
    Vector<N> x;
    for (int i = 0; i < N; ++i) {
      double sum = b[i];
      for (int k = 0; k < i; ++k) sum -= L_(i, k) * x[k];
      x[i] = sum * reciprocal_[i];
    }
    return x;
  }

  // The same in place, for N numbers of a type that doubles multiply: Pair solves for two at once.
  template <typename T>
  void solve_lower(T (&x)[N]) const {
    for (int i = 0; i < N; ++i) {
      T sum = x[i];
      for (int k = 0; k < i; ++k) sum -= L_(i, k) * x[k];
      x[i] = sum * reciprocal_[i];
    }
  }

  // x with A x = b.
  Vector<N> solve(const Vector<N>& b) const {
    Vector<N> x = solve_lower(b);
    for (int i = N - 1; i >= 0; --i) {
      double sum = x[i];
      for (int k = i + 1; k < N; ++k) sum -= L_(k, i) * x[k];
      x[i] = sum * reciprocal_[i];
    }
    return x;
  }

  // A⁻¹, exactly symmetric.
  Matrix<N, N> inverse() const {
    Matrix<N, N> M;  // L⁻¹, lower triangle
    for (int j = 0; j < N; ++j) {
      M(j, j) = reciprocal_[j];
      for (int i = j + 1; i < N; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) sum -= L_(i, k) * M(k, j);
        M(i, j) = sum * reciprocal_[i];
      }
    }
    Matrix<N, N> inverse;  // L⁻ᵀ L⁻¹
    for (int i = 0; i < N; ++i)
      for (int j = 0; j <= i; ++j) {
        double sum = 0;
        for (int k = i; k < N; ++k) sum += M(k, i) * M(k, j);
        inverse(i, j) = sum;
        inverse(j, i) = sum;
      }
    return inverse;
  }

 private:
  Matrix<N, N> L_;
  Vector<N> reciprocal_;  // 1 / L(i, i)
};

}  // namespace plvo
