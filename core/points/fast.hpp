// SPDX-License-Identifier: Apache-2.0
// The segment test (Rosten & Drummond, "Machine learning for high-speed corner detection", ECCV 2006): a
// pixel is a corner candidate when nine contiguous pixels of the sixteen on the circle of radius three around
// it are all brighter, or all darker, by more than a threshold.
#pragma once

#include <cstddef>
#include <cstdint>

namespace plvo {

// centre points at the pixel, stride is its image's; three pixels of margin on every side.
bool segment_test(const std::uint8_t* centre, std::ptrdiff_t stride, int threshold);

// The test of 4 pixels that any corner must pass; for whole rows at once. mask[i] ≠ 0 where segment_test(row
// + i) may be true; where it is 0, segment_test is false.
void segment_pretest_row(const std::uint8_t* row, std::ptrdiff_t stride, int width, int threshold,
                         std::uint8_t* mask);

}  // namespace plvo
