// SPDX-License-Identifier: Apache-2.0
// Eigen writes an assignment of up to about a hundred operations out, entry after entry. Where code shall be
// small, a loop over the entries does it instead: each entry is computed as before, so the bits are the same.
// Sums (dot products, the entries of a product) stay written out: Eigen adds them in another order in a loop.
// Made for Eigen 3.4; golden_test shows whether the bits are the same.
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

}  // namespace Eigen::internal
