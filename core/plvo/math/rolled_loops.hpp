// SPDX-License-Identifier: Apache-2.0
// Eigen writes an assignment of up to about a hundred operations out, entry after entry, and so it does with
// questions about all entries. Here a loop over the entries does it instead, which the compiler may still
// unroll: each entry is computed as before, so the bits are the same. Sums (dot products, the entries of a
// product) stay written out: Eigen adds them in another order in a loop. Made for Eigen 3.4; golden_test
// shows whether the bits are the same.
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

// A triangle.
template <int UpLo, int Mode, int SetOpposite, typename To, typename From, typename Assign, int Version,
          unsigned int LoopMode, int Count, bool LoopSetOpposite>
requires(Count > 0) struct triangular_assignment_loop<
    triangular_dense_assignment_kernel<UpLo, Mode, SetOpposite, To, From, Assign, Version>, LoopMode, Count,
    LoopSetOpposite>
    : triangular_assignment_loop<
          triangular_dense_assignment_kernel<UpLo, Mode, SetOpposite, To, From, Assign, Version>, LoopMode,
          Dynamic, LoopSetOpposite> {
};

// all(): hasNaN(), allFinite().
template <typename Mask, int Count, int Rows>
requires(Count > 0) struct all_unroller<Mask, Count, Rows> {
  static bool run(const Mask& mask) {
    for (int i = 0; i < Count; ++i)
      if (!mask.coeff(i % Rows, i / Rows)) return false;
    return true;
  }
};

// The largest and the least are the same in any order.
template <int NaN, typename Entries>
struct redux_impl<scalar_max_op<double, double, NaN>, Entries, DefaultTraversal, CompleteUnrolling>
    : redux_impl<scalar_max_op<double, double, NaN>, Entries, DefaultTraversal, NoUnrolling> {};

template <int NaN, typename Entries>
struct redux_impl<scalar_min_op<double, double, NaN>, Entries, DefaultTraversal, CompleteUnrolling>
    : redux_impl<scalar_min_op<double, double, NaN>, Entries, DefaultTraversal, NoUnrolling> {};

}  // namespace Eigen::internal
