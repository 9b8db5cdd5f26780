// SPDX-License-Identifier: Apache-2.0
// Two lists of stamps joined by time, as the TUM benchmark's associate script does: of all pairs within the
// tolerance the closest comes first (of equally close ones that with the smallest index in the first list,
// then in the second), each stamp is used once. In O(n log n), however wide the tolerance is: at every step
// the closest pair of all stamps that are left lies side by side in their common order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace plvo {

// first and second: strictly increasing. Indices into the lists, increasing in the first. tolerance_ns: the
// largest difference of a pair; a negative one pairs nothing.
std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<std::int64_t>& first,
                                                           const std::vector<std::int64_t>& second,
                                                           std::int64_t tolerance_ns);

}  // namespace plvo
