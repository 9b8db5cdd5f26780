// SPDX-License-Identifier: Apache-2.0
// Which directions point the same way as another, up to a tolerance: what grows a region, and what counts a
// rectangle's aligned pixels.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "plvo/base/build.hpp"
#include "plvo/base/lanes.hpp"
#include "plvo/lines/lsd/level_line_field.hpp"
#include "plvo/lines/lsd/line_support_region.hpp"

namespace plvo::lsd {

// The two sides of a wedge: a direction is in it when its products with both are below 0. In 16 bits, which
// is as much as a direction has; a pixel without a direction is in none.
struct Wedge {
  std::int16_t left_x, left_y, right_x, right_y;

  bool holds(Direction d) const {
    return d.x * left_x + d.y * left_y < 0 && d.x * right_x + d.y * right_y < 0;
  }
};

// About (x, y), which may have any length from 2^13 on. Its sides are off by at most 0.016°.
inline Wedge make_wedge(std::int64_t x, std::int64_t y, Tolerance tolerance) {
  const auto size = [](std::int64_t v) { return static_cast<std::uint64_t>(v < 0 ? -v : v); };
  const int excess = static_cast<int>(std::bit_width(size(x) | size(y))) - kDirectionBits;
  const int shift = excess > 0 ? excess : 0;
  const auto short_x = static_cast<std::int32_t>(x >> shift);
  const auto short_y = static_cast<std::int32_t>(y >> shift);
  const std::int32_t along_x = short_x * tolerance.tangent_q15 >> 15;
  const std::int32_t along_y = short_y * tolerance.tangent_q15 >> 15;
  return {static_cast<std::int16_t>(short_y - along_x), static_cast<std::int16_t>(-short_x - along_y),
          static_cast<std::int16_t>(-short_y - along_x), static_cast<std::int16_t>(short_x - along_y)};
}

#ifndef PLVO_LANE_LOOPS
// A wedge that four directions at once are held against.
class WedgeLanes {
 public:
  WedgeLanes() = default;
  explicit WedgeLanes(const Wedge& wedge) {
    repeat(wedge.left_x, wedge.left_y, left_);
    repeat(wedge.right_x, wedge.right_y, right_);
  }
  // Bit i: the direction four[i] is in it.
  unsigned holding(const Direction* four) const {
    static_assert(sizeof(Direction) == 2 * sizeof(std::int16_t));
    Lanes row;
    std::memcpy(&row, four, sizeof row);
    WideLanes left, right;
    dot_pairs(row, left_, left);
    dot_pairs(row, right_, right);
    return negative_lanes(left & right);
  }

 private:
  static void repeat(std::int16_t x, std::int16_t y, Lanes& lanes) {
    const WideLanes four = WideLanes{} + static_cast<std::int32_t>(
                                             static_cast<std::uint16_t>(x) |
                                             static_cast<std::uint32_t>(static_cast<std::uint16_t>(y)) << 16);
    std::memcpy(&lanes, &four, sizeof lanes);
  }

  Lanes left_{}, right_{};
};
#endif

// How many of a row's directions from x = first to x = last are in it. Behind the row at least three more
// must be there to be read.
inline int count_held(const Wedge& wedge, const Direction* row, int first, int last) {
  int held = 0;
  int x = first;
#ifndef PLVO_LANE_LOOPS
  // By table: not every processor counts bits in one instruction.
  constexpr std::uint8_t kOnes[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
  const WedgeLanes lanes(wedge);
  for (; x + 3 <= last; x += 4) held += kOnes[lanes.holding(row + x)];
  if (x <= last) held += kOnes[lanes.holding(row + x) & ((1U << (last - x + 1)) - 1)];
#else
  for (; x <= last; ++x) held += wedge.holds(row[x]) ? 1 : 0;
#endif
  return held;
}

}  // namespace plvo::lsd
