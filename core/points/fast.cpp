// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/fast.hpp"

#include <array>

namespace plvo {
namespace {

struct Offset {
  int dx, dy;
};
// Clockwise from the top.
constexpr std::array<Offset, 16> kCircle = {{{0, -3},
                                             {1, -3},
                                             {2, -2},
                                             {3, -1},
                                             {3, 0},
                                             {3, 1},
                                             {2, 2},
                                             {1, 3},
                                             {0, 3},
                                             {-1, 3},
                                             {-2, 2},
                                             {-3, 1},
                                             {-3, 0},
                                             {-3, -1},
                                             {-2, -2},
                                             {-1, -3}}};

// Whether nine neighbouring bits of the circular 16-bit mask are set.
bool has_run_of_nine(std::uint32_t mask) {
  mask |= mask << 16;
  mask &= mask >> 1;  // runs of 2
  mask &= mask >> 2;  // 4
  mask &= mask >> 4;  // 8
  mask &= mask >> 1;  // 9
  return (mask & 0xffff) != 0;
}

}  // namespace

bool segment_test(const std::uint8_t* centre, std::ptrdiff_t stride, int threshold) {
  const int high = *centre + threshold;
  const int low = *centre - threshold;
  std::uint32_t brighter = 0;
  std::uint32_t darker = 0;
  for (std::size_t i = 0; i < kCircle.size(); ++i) {
    const int value = centre[kCircle[i].dy * stride + kCircle[i].dx];
    brighter |= static_cast<std::uint32_t>(value > high) << i;
    darker |= static_cast<std::uint32_t>(value < low) << i;
  }
  return has_run_of_nine(brighter) || has_run_of_nine(darker);
}

void segment_pretest_row(const std::uint8_t* row, std::ptrdiff_t stride, int width, int threshold,
                         std::uint8_t* mask) {
  // A run of nine covers at least one of any two opposite pixels, here for two such pairs. Saturating
  // arithmetic written with selects on bytes, which compilers turn into vector code.
  const std::uint8_t* top = row - 3 * stride;
  const std::uint8_t* bottom = row + 3 * stride;
  const auto t = static_cast<std::uint8_t>(threshold);
  for (int x = 0; x < width; ++x) {
    const std::uint8_t centre = row[x];
    const auto high = static_cast<std::uint8_t>(centre > 255 - t ? 255 : centre + t);
    const auto low = static_cast<std::uint8_t>(centre < t ? 0 : centre - t);
    const auto vertical_max = top[x] > bottom[x] ? top[x] : bottom[x];
    const auto vertical_min = top[x] < bottom[x] ? top[x] : bottom[x];
    const auto horizontal_max = row[x - 3] > row[x + 3] ? row[x - 3] : row[x + 3];
    const auto horizontal_min = row[x - 3] < row[x + 3] ? row[x - 3] : row[x + 3];
    const auto least_max = vertical_max < horizontal_max ? vertical_max : horizontal_max;
    const auto greatest_min = vertical_min > horizontal_min ? vertical_min : horizontal_min;
    mask[x] = static_cast<std::uint8_t>((least_max > high) | (greatest_min < low));
  }
}

}  // namespace plvo
