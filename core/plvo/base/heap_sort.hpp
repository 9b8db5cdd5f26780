// SPDX-License-Identifier: Apache-2.0
// Sorting in place without recursion, in at most about 2 n log2 n comparisons whatever the order was: the
// stack has a bound that can be read from the call graph, which std::sort's has not.
#pragma once

#include <cstddef>

namespace plvo {

// `less` must be a total order (no two elements equal) where the result must not depend on the algorithm.
template <typename T, typename Less>
void heap_sort(T* first, T* last, const Less& less) {
  std::ptrdiff_t root = (last - first) / 2;  // behind it are leaves
  std::ptrdiff_t end = last - first;
  while (end > 1) {
    T item;
    if (root > 0) {  // the heap is being made
      item = first[--root];
    } else {  // its greatest goes behind it
      item = first[--end];
      first[end] = first[0];
    }
    std::ptrdiff_t hole = root;
    for (std::ptrdiff_t child; (child = 2 * hole + 1) < end; hole = child) {
      if (child + 1 < end && less(first[child], first[child + 1])) ++child;
      first[hole] = first[child];
    }
    // Down to a leaf and up again: what comes from the end of the heap belongs near a leaf, and a step up
    // takes one comparison where a step down takes two.
    for (std::ptrdiff_t parent; hole > root && less(first[parent = (hole - 1) / 2], item); hole = parent)
      first[hole] = first[parent];
    first[hole] = item;
  }
}

}  // namespace plvo
