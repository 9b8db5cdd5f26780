// SPDX-License-Identifier: Apache-2.0
// The segment test (Rosten & Drummond, "Machine learning for high-speed corner detection", ECCV 2006). A
// pixel is a corner if nine contiguous pixels of the sixteen on the circle of radius three around it are all
// brighter, or all darker, by more than a threshold. This function computes the largest such threshold for
// whole rows, so that the caller can choose a threshold afterwards.
#pragma once

#include <cstddef>
#include <cstdint>

namespace plvo {

// scores[i]: pixel row[i] passes the segment test for every threshold t < scores[i] (grey levels). A pixel
// with score 0 never passes. Thresholds below floor are not used: a score that does not exceed floor may be
// replaced by any number up to floor. row points into an image of the given stride, with a margin of three
// pixels on every side. scores must not overlap it.
void segment_test_row(const std::uint8_t* row, std::ptrdiff_t stride, int width, std::uint8_t floor,
                      std::uint8_t* __restrict scores);

}  // namespace plvo
