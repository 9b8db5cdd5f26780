// SPDX-License-Identifier: Apache-2.0
// A putative correspondence: feature `reference` of the reference frame is feature `current` of this frame.
#pragma once

#include <cstdint>

namespace plvo {

struct Match {
  std::uint16_t reference = 0;
  std::uint16_t current = 0;
};

}  // namespace plvo
