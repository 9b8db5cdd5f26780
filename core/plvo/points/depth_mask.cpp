// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/depth_mask.hpp"

#include <array>
#include <cstring>
#include <limits>
#include <span>

#include "plvo/base/simd.hpp"

namespace plvo {
namespace {

// Erosion of the mask in pixels of the keypoint's level: one for the reach of the gradient, one for the
// registration error between colour and depth.
constexpr int kRim = 2;
// Relative depth tolerance. A steep surface changes its depth by this much over a window; pixels that differ
// more belong to another surface.
constexpr double kSameSurface = 0.06;
// Pixels without depth belong to the keypoint's surface if readings of this surface surround them: if every
// square of side 2 · kHole + 1 that contains the pixel contains such a reading. Beside an edge this is not
// so, whatever the width of the shadow between the two surfaces.
constexpr int kHole = 1;

constexpr int kSurfaceReach = kWindowReach + kRim;
constexpr int kSurfaceColumns = kWindowColumns + 2 * kRim;
constexpr int kSurfaceRows = kWindowRows + 2 * kRim;
using Row = std::uint16_t;  // one bit per column, kRim columns to either side of the window
using SurfaceBits = std::array<Row, kSurfaceRows>;
// The readings that decide about the holes in these rows and columns.
constexpr int kHoleReach = kSurfaceReach + 2 * kHole;
constexpr int kHoleColumns = kSurfaceColumns + 4 * kHole;
constexpr int kHoleRows = kSurfaceRows + 4 * kHole;
using WideRow = std::uint32_t;
static_assert(kHoleColumns == 16);

// The depths that belong to the keypoint's surface, in units of the image. 0 means no depth.
struct DepthRange {
  std::int32_t first, last;
};

DepthRange range_around(double units) {
  const auto whole = [](double x) { return x < 65535 ? static_cast<std::int32_t>(x) : 65535; };
  return {whole((1 - kSameSurface) * units) + 1, whole((1 + kSameSurface) * units)};
}

#ifndef PLVO_SIMD_LOOPS

// Eight readings, `step` apart.
void load_eight(const std::uint16_t* readings, int step, Int16x8& units) {
  if (step == 1)
    std::memcpy(&units, readings, sizeof units);
  else
    for (int i = 0; i < 8; ++i) units[i] = static_cast<std::int16_t>(readings[i * step]);
}

// Returns one bit for each of eight readings, which is set if the reading is in the range.
std::uint32_t own_of_eight(const Int16x8& units, const DepthRange& range) {
  // Subtracts 2^15 from both sides, so that signed comparison orders unsigned values.
  const auto first = static_cast<std::int16_t>(range.first - 32768);
  const auto last = static_cast<std::int16_t>(range.last - 32768);
  const Int16x8 shifted = units ^ std::numeric_limits<std::int16_t>::min();
  return negative_mask((shifted >= first) & (shifted <= last));
}

#endif

// Reads pixels of the keypoint's level around its centre.
class LevelReadings {
 public:
  LevelReadings(const DepthSampler& depth, const DepthSampler::Place& place, int level)
      : depth_(depth),
        place_(place),
        step_(1 << level),
        straight_(place.map.is_straight(1.0 / kSurfaceReach)) {}

  bool straight() const { return straight_; }
  int step() const { return step_; }
  // The reading of a pixel, by its offset from the centre in pixels of the level. 0: no depth; kOutside: the
  // image does not contain the pixel.
  static constexpr std::int32_t kOutside = -1;
  std::int32_t at(int column, int row) const { return offset(column * step_, row * step_); }
  // The readings of a row from column −reach on, step() apart, if the image contains the square of this reach
  // around the centre and the pixels that its pixels cover; otherwise nullptr.
  const std::uint16_t* row(int row, int reach) const {
    const int from_centre = reach * step_;
    if (!straight_ || !depth_.holds_raw(place_.x - from_centre, place_.y - from_centre) ||
        !depth_.holds_raw(place_.x + from_centre + step_, place_.y + from_centre + step_))
      return nullptr;
    return depth_.raw(place_.x - from_centre, place_.y + row * step_);
  }
  // A reading as by at(); on levels above 0, a missing reading is replaced by one of the adjacent pixels that
  // the level's pixel covers too.
  std::int32_t covered(int column, int row) const {
    std::int32_t units = at(column, row);
    for (int i = 1; i < 4 && units == 0 && step_ > 1; ++i) {
      const std::int32_t beside = offset(column * step_ + (i & 1), row * step_ + (i >> 1));
      if (beside > 0) units = beside;
    }
    return units;
  }

 private:
  std::int32_t offset(int right, int down) const {
    int x = place_.x + right;
    int y = place_.y + down;
    if (!straight_ && !place_.map.raw_pixel(right, down, x, y)) return kOutside;
    return depth_.holds_raw(x, y) ? *depth_.raw(x, y) : kOutside;
  }

  const DepthSampler& depth_;
  const DepthSampler::Place& place_;
  int step_;
  bool straight_;
};

// Shrinks (shrink) or grows a region by `reach` pixels in both directions. Row r and bit c of the result are
// row r + reach and bit c + reach of the region. The last 2 · reach rows become invalid.
template <typename Bits>
void grow(std::span<Bits> rows, int reach) {
  const auto side = static_cast<std::size_t>(2 * reach);
  for (Bits& row : rows) {
    Bits grown = row;
    for (int i = 1; i <= 2 * reach; ++i) grown |= static_cast<Bits>(row >> i);
    row = grown;
  }
  for (std::size_t r = 0; r + side < rows.size(); ++r)
    for (std::size_t i = 1; i <= side; ++i) rows[r] |= rows[r + i];
}
template <typename Bits>
void shrink(std::span<Bits> rows, int reach) {
  const auto side = static_cast<std::size_t>(2 * reach);
  for (Bits& row : rows) {
    Bits shrunk = row;
    for (int i = 1; i <= 2 * reach; ++i) shrunk &= static_cast<Bits>(row >> i);
    row = shrunk;
  }
  for (std::size_t r = 0; r + side < rows.size(); ++r)
    for (std::size_t i = 1; i <= side; ++i) rows[r] &= rows[r + i];
}

// Returns the pixels of the keypoint's surface and those without depth that it surrounds.
SurfaceBits fill_holes(const LevelReadings& readings, const DepthRange& range) {
  std::array<WideRow, kHoleRows> own{}, other{};
  for (int r = 0; r < kHoleRows; ++r) {
    const std::uint16_t* const row = readings.row(r - kHoleReach, kHoleReach);
#ifndef PLVO_SIMD_LOOPS
    if (row != nullptr) {
      for (int c = 0; c < kHoleColumns; c += 8) {
        Int16x8 units;
        load_eight(row + c * readings.step(), readings.step(), units);
        if (readings.step() > 1 && negative_mask(units == 0) != 0)
          for (int i = 0; i < 8; ++i)
            if (units[i] == 0)
              units[i] = static_cast<std::int16_t>(readings.covered(c + i - kHoleReach, r - kHoleReach));
        const std::uint32_t in_range = own_of_eight(units, range);
        own[static_cast<std::size_t>(r)] |= in_range << c;
        other[static_cast<std::size_t>(r)] |= (negative_mask(units != 0) & ~in_range) << c;
      }
      continue;
    }
#endif
    for (int c = 0; c < kHoleColumns; ++c) {
      std::int32_t units = row != nullptr ? row[c * readings.step()] : 0;
      if (units == 0 && (row == nullptr || readings.step() > 1))
        units = readings.covered(c - kHoleReach, r - kHoleReach);
      if (units <= 0) continue;
      const bool is_own = units >= range.first && units <= range.last;
      (is_own ? own : other)[static_cast<std::size_t>(r)] |= WideRow{1} << c;
    }
  }
  // Growing and shrinking by the same amount closes the holes that the surface surrounds.
  grow(std::span<WideRow>(own), kHole);
  shrink(std::span<WideRow>(own).first(kHoleRows - 2 * kHole), kHole);
  SurfaceBits filled;
  for (std::size_t r = 0; r < filled.size(); ++r)
    filled[r] = static_cast<Row>(own[r] & ~(other[r + 2 * kHole] >> (2 * kHole)));
  return filled;
}

}  // namespace

WindowMask depth_mask(const DepthSampler& depth, const Vector2& centre, double depth_m, int level) {
  WindowMask mask{};
  const DepthSampler::Place place(depth, centre);
  if (!place.inside) return mask;
  const LevelReadings readings(depth, place, level);
  const DepthRange range = range_around(depth_m / depth.metres_per_unit());
  SurfaceBits own{};
  bool holes = false;
#ifndef PLVO_SIMD_LOOPS
  const int step = readings.step();
  const int left = place.x - kSurfaceReach * step;
  const int top = place.y - kSurfaceReach * step;
  Int16x8 missing{};
  const bool whole = readings.straight() && depth.holds_raw(left, top) &&
                     depth.holds_raw(left + (kSurfaceColumns - 1) * step, top + (kSurfaceRows - 1) * step);
#else
  constexpr bool whole = false;
#endif
  for (int r = 0; r < kSurfaceRows; ++r) {
    std::uint32_t bits = 0;
#ifndef PLVO_SIMD_LOOPS
    if (whole) {
      const std::uint16_t* const row = depth.raw(left, top + r * step);
      for (const int c : {0, kSurfaceColumns - 8}) {
        Int16x8 units;
        load_eight(row + c * step, step, units);
        missing |= units == 0;
        bits |= own_of_eight(units, range) << c;
      }
    }
#endif
    for (int c = kSurfaceColumns; !whole && c-- > 0;) {
      const std::int32_t units = readings.at(c - kSurfaceReach, r - kSurfaceReach);
      holes = holes || units == 0;
      bits = bits << 1 | static_cast<std::uint32_t>(units >= range.first && units <= range.last);
    }
    own[static_cast<std::size_t>(r)] = static_cast<Row>(bits);
  }
#ifndef PLVO_SIMD_LOOPS
  holes = holes || negative_mask(missing) != 0;
#endif
  if (holes) own = fill_holes(readings, range);
  shrink(std::span<Row>(own), kRim);
  for (std::size_t r = 0; r < mask.size(); ++r) mask[r] = static_cast<std::uint8_t>(own[r]);
  return mask;
}

}  // namespace plvo
