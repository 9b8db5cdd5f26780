// SPDX-License-Identifier: Apache-2.0
// Eigen fully unrolls assignments of up to about a hundred operations, and likewise predicates over all
// entries. These specialisations use a loop over the entries instead, which the compiler may still unroll.
// Each entry is computed as before, so the results are bit-identical. Sums (dot products, the entries of a
// product) stay unrolled, because Eigen adds in a different order in a loop. This file assumes Eigen 3.4;
// golden_test detects differences.
#pragma once

#include <Eigen/Core>

namespace Eigen::internal {

template <typename To, typename From, typename Assign, int Version>
struct dense_assignment_loop<generic_dense_assignment_kernel<To, From, Assign, Version>, DefaultTraversal,
                             CompleteUnrolling>
    : dense_assignment_loop<generic_dense_assignment_kernel<To, From, Assign, Version>, DefaultTraversal,
                            NoUnrolling> {};

template <typename To, typename From, typename Assign, int Version>
struct dense_assignment_loop<generic_dense_assignment_kernel<To, From, Assign, Version>, DefaultTraversal,
                             InnerUnrolling>
    : dense_assignment_loop<generic_dense_assignment_kernel<To, From, Assign, Version>, DefaultTraversal,
                            NoUnrolling> {};

template <typename To, typename From, typename Assign, int Version>
struct dense_assignment_loop<generic_dense_assignment_kernel<To, From, Assign, Version>, LinearTraversal,
                             CompleteUnrolling>
    : dense_assignment_loop<generic_dense_assignment_kernel<To, From, Assign, Version>, LinearTraversal,
                            NoUnrolling> {};

// Assignment of a triangle.
template <int UpLo, int Mode, int SetOpposite, typename To, typename From, typename Assign, int Version,
          unsigned int LoopMode, int Count, bool LoopSetOpposite>
requires(Count > 0) struct triangular_assignment_loop<
    triangular_dense_assignment_kernel<UpLo, Mode, SetOpposite, To, From, Assign, Version>, LoopMode, Count,
    LoopSetOpposite>
    : triangular_assignment_loop<
          triangular_dense_assignment_kernel<UpLo, Mode, SetOpposite, To, From, Assign, Version>, LoopMode,
          Dynamic, LoopSetOpposite> {
};

// all(), which hasNaN() and allFinite() use.
template <typename Mask, int Count, int Rows>
requires(Count > 0) struct all_unroller<Mask, Count, Rows> {
  static bool run(const Mask& mask) {
    for (int i = 0; i < Count; ++i)
      if (!mask.coeff(i % Rows, i / Rows)) return false;
    return true;
  }
};

// The maximum and the minimum do not depend on the order.
template <int NaN, typename Entries>
struct redux_impl<scalar_max_op<double, double, NaN>, Entries, DefaultTraversal, CompleteUnrolling>
    : redux_impl<scalar_max_op<double, double, NaN>, Entries, DefaultTraversal, NoUnrolling> {};

template <int NaN, typename Entries>
struct redux_impl<scalar_min_op<double, double, NaN>, Entries, DefaultTraversal, CompleteUnrolling>
    : redux_impl<scalar_min_op<double, double, NaN>, Entries, DefaultTraversal, NoUnrolling> {};

}  // namespace Eigen::internal
