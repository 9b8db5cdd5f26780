// SPDX-License-Identifier: Apache-2.0
// Time between two stamps, in nanoseconds.
#pragma once

#include <cstdint>
#include <limits>

namespace plvo {

// Time from an earlier stamp to a later one. Stamps may have any value: a difference that does not fit
// saturates.
inline std::int64_t elapsed_ns(std::int64_t from, std::int64_t to) {
  const std::uint64_t elapsed = static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  return elapsed > static_cast<std::uint64_t>(kMost) ? kMost : static_cast<std::int64_t>(elapsed);
}

}  // namespace plvo
