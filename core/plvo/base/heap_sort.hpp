// SPDX-License-Identifier: Apache-2.0
// In-place heap sort without recursion, in at most about 2 n log2 n comparisons for any input. The call graph
// bounds its stack, unlike that of std::sort.
#pragma once

#include <cstddef>

namespace plvo {

// `less` must be a total order without equal elements if the result shall not depend on the algorithm.
template <typename T, typename Less>
void heap_sort(T* first, T* last, const Less& less) {
  std::ptrdiff_t root = (last - first) / 2;  // all elements from here on are leaves
  std::ptrdiff_t end = last - first;
  while (end > 1) {
    T item;
    if (root > 0) {  // building the heap
      item = first[--root];
    } else {  // moving the maximum behind the heap
      item = first[--end];
      first[end] = first[0];
    }
    std::ptrdiff_t hole = root;
    for (std::ptrdiff_t child; (child = 2 * hole + 1) < end; hole = child) {
      if (child + 1 < end && less(first[child], first[child + 1])) ++child;
      first[hole] = first[child];
    }
    // Sift down to a leaf, then up again. An element from the end of the heap belongs near a leaf, and a step
    // up costs one comparison instead of two.
    for (std::ptrdiff_t parent; hole > root && less(first[parent = (hole - 1) / 2], item); hole = parent)
      first[hole] = first[parent];
    first[hole] = item;
  }
}

}  // namespace plvo
