// SPDX-License-Identifier: Apache-2.0
// Joins two lists of stamps by time, like the TUM benchmark's associate script. Of all pairs within the
// tolerance the closest is taken first; of equally close ones, that with the smallest index in the first
// list, then in the second. Each stamp is used once. It takes O(n log n) for any tolerance, because at every
// step the closest pair of the remaining stamps is adjacent in their common order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace plvo {

// first and second: strictly increasing. Returns indices into the lists, increasing in the first.
// tolerance_ns: the largest difference of a pair; a negative one gives no pairs.
std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<std::int64_t>& first,
                                                           const std::vector<std::int64_t>& second,
                                                           std::int64_t tolerance_ns);

}  // namespace plvo
