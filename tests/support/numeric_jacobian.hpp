// SPDX-License-Identifier: Apache-2.0
// ∂f/∂x by central differences: the slow, obvious statement that analytic Jacobians are compared with.
#pragma once

#include "plvo/math/types.hpp"

namespace plvo {

template <int Rows, int Cols, typename Function>
Matrix<Rows, Cols> numeric_jacobian(const Function& f, const Vector<Cols>& x, double step) {
  Matrix<Rows, Cols> J;
  for (int j = 0; j < Cols; ++j) {
    Vector<Cols> forward = x;
    Vector<Cols> backward = x;
    forward(j) += step;
    backward(j) -= step;
    const Vector<Rows> difference = f(forward) - f(backward);
    J.col(j) = difference / (forward(j) - backward(j));
  }
  return J;
}

}  // namespace plvo
