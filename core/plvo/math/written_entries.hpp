// SPDX-License-Identifier: Apache-2.0
// Eigen's M << a, b, … computes the position of every entry at run time, with one call each. In
// size-optimised code, this specialisation computes the positions at compile time. It assumes Eigen 3.4 and
// supports scalars only.
#pragma once

#include <Eigen/Core>

namespace Eigen {

template <int Rows, int Columns, int Options>
struct CommaInitializer<Matrix<double, Rows, Columns, Options>> {
  using Entries = Matrix<double, Rows, Columns, Options>;

  __attribute__((always_inline)) CommaInitializer(Entries& entries, double first) : entries_(entries) {
    entries_.coeffRef(0, 0) = first;
  }
  __attribute__((always_inline)) CommaInitializer& operator,(double next) {
    entries_.coeffRef(count_ / Columns, count_ % Columns) = next;
    ++count_;
    return *this;
  }
  ~CommaInitializer() { eigen_assert(count_ == Rows * Columns); }

 private:
  Entries& entries_;
  int count_ = 1;
};

}  // namespace Eigen
