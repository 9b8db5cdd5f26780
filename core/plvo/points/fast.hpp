// SPDX-License-Identifier: Apache-2.0
// The segment test (Rosten & Drummond, "Machine learning for high-speed corner detection", ECCV 2006): a
// pixel is a corner when nine contiguous pixels of the sixteen on the circle of radius three around it are
// all brighter, or all darker, by more than a threshold. What is computed here is the largest such threshold,
// for whole rows at once, so that a threshold can be chosen afterwards.
#pragma once

#include <cstddef>
#include <cstdint>

namespace plvo {

// scores[i]: the pixel row[i] passes the segment test for every threshold t < scores[i] (grey levels; 0: for
// none). Nobody asks for thresholds below floor: where the score is not above it, any number up to it may
// stand instead. row points into an image of that stride with three pixels of margin on every side; scores
// does not overlap it.
void segment_test_row(const std::uint8_t* row, std::ptrdiff_t stride, int width, std::uint8_t floor,
                      std::uint8_t* __restrict scores);

}  // namespace plvo
