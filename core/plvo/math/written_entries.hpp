// SPDX-License-Identifier: Apache-2.0
// M << a, b, … as Eigen has it asks at run time, for every entry, where it belongs: a call each. Where code
// shall be small, each is stored where it belongs when that is compiled. Made for Eigen 3.4, for single
// numbers alone.
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
