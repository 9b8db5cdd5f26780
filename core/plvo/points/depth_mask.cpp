// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/depth_mask.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "plvo/base/simd.hpp"

namespace plvo {
namespace {

// Erosion of the mask in pixels of the keypoint's level: one for the reach of the gradient, one for the
// registration error between colour and depth.
constexpr int kRim = 2;
// Relative depth tolerance. A steep surface changes its depth by this much over a window; pixels that differ
// more belong to another surface.
constexpr double kSameSurface = 0.06;

constexpr int kSurfaceReach = kWindowReach + kRim;
constexpr int kSurfaceColumns = kWindowColumns + 2 * kRim;
constexpr int kSurfaceRows = kWindowRows + 2 * kRim;
using Row = std::uint16_t;  // one bit per column, kRim columns to either side of the window

// The depths that belong to the keypoint's surface, in units of the image. 0 means no depth.
struct Range {
  std::int32_t first, last;
};

Range range_around(double units) {
  const auto whole = [](double x) { return x < 65535 ? static_cast<std::int32_t>(x) : 65535; };
  return {whole((1 - kSameSurface) * units) + 1, whole((1 + kSameSurface) * units)};
}

#ifndef PLVO_SIMD_LOOPS

// Returns one bit for each of eight readings, `step` apart. A bit is set if the reading is in the range.
std::uint32_t own_of_eight(const std::uint16_t* readings, int step, const Range& range) {
  Int16x8 units;
  if (step == 1)
    std::memcpy(&units, readings, sizeof units);
  else
    for (int i = 0; i < 8; ++i) units[i] = static_cast<std::int16_t>(readings[i * step]);
  // Subtracts 2^15 from both sides, so that signed comparison orders unsigned values.
  const auto first = static_cast<std::int16_t>(range.first - 32768);
  const auto last = static_cast<std::int16_t>(range.last - 32768);
  units ^= std::numeric_limits<std::int16_t>::min();
  const Int16x8 own = (units >= first) & (units <= last) & 1;
  std::uint8_t bytes[8];
  store_bytes(own, bytes);
  std::uint64_t together;
  std::memcpy(&together, bytes, sizeof together);
  static_assert(std::endian::native == std::endian::little);
  return static_cast<std::uint32_t>((together * 0x0102040810204080) >> 56);  // byte i to bit 56 + i
}

#endif

}  // namespace

WindowMask depth_mask(const DepthSampler& depth, const Vector2& centre, double depth_m, int level) {
  WindowMask mask{};
  const DepthSampler::Place place(depth, centre);
  if (!place.inside) return mask;
  const int step = 1 << level;
  const int left = place.x - kSurfaceReach * step;
  const int top = place.y - kSurfaceReach * step;
  const Range range = range_around(depth_m / depth.metres_per_unit());
  std::array<Row, kSurfaceRows> own{};
  const bool straight = place.map.is_straight(1.0 / kSurfaceReach);
#ifndef PLVO_SIMD_LOOPS
  const bool whole = straight && depth.holds_raw(left, top) &&
                     depth.holds_raw(left + (kSurfaceColumns - 1) * step, top + (kSurfaceRows - 1) * step);
#else
  constexpr bool whole = false;
#endif
  for (int r = 0; r < kSurfaceRows; ++r) {
    std::uint32_t bits = 0;
#ifndef PLVO_SIMD_LOOPS
    if (whole) {
      const std::uint16_t* const row = depth.raw(left, top + r * step);
      bits = own_of_eight(row, step, range) | own_of_eight(row + (kSurfaceColumns - 8) * step, step, range)
                                                  << (kSurfaceColumns - 8);
    }
#endif
    for (int c = kSurfaceColumns; !whole && c-- > 0;) {
      int x = left + c * step;
      int y = top + r * step;
      bool seen = true;
      if (!straight) seen = place.map.raw_pixel((c - kSurfaceReach) * step, (r - kSurfaceReach) * step, x, y);
      const std::int32_t units = seen ? depth.raw_units(x, y) : 0;
      bits = bits << 1 | static_cast<std::uint32_t>(units >= range.first && units <= range.last);
    }
    own[static_cast<std::size_t>(r)] = static_cast<Row>(bits);
  }
  // Erosion by kRim in both directions: along the rows by shifts, then over adjacent rows.
  for (Row& row : own) {
    Row shrunk = row;
    for (int i = 1; i <= 2 * kRim; ++i) shrunk &= static_cast<Row>(row >> i);
    row = shrunk;
  }
  for (std::size_t r = 0; r < mask.size(); ++r) {
    Row bits = own[r];
    for (std::size_t i = 1; i <= 2 * kRim; ++i) bits &= own[r + i];
    mask[r] = static_cast<std::uint8_t>(bits);
  }
  return mask;
}

}  // namespace plvo
