// SPDX-License-Identifier: Apache-2.0
// Sorting in place without recursion, in at most about 2 n log2 n comparisons whatever the order was: the
// stack has a bound that can be read from the call graph, which std::sort's has not.
#pragma once

#include <algorithm>

namespace plvo {

// `less` must be a total order (no two elements equal) where the result must not depend on the algorithm.
template <typename T, typename Less>
void heap_sort(T* first, T* last, Less less) {
  std::make_heap(first, last, less);
  std::sort_heap(first, last, less);
}

}  // namespace plvo
