// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/undistortion.hpp"

#include <algorithm>

#include "plvo/base/build.hpp"
#include "plvo/base/simd.hpp"
#include "plvo/math/rounding.hpp"

namespace plvo {
namespace {

constexpr int kWeightBits = 7;  // fraction bits of a position in the blend
constexpr int kRowBits = 10;    // fraction bits of a position within a row of a cell
constexpr int kRowShift = 16 - kRowBits;
// Limits within a row, in px: kMostWay for the distance of a pixel from the first one, kMostOutside for the
// distance of the first one from the border of the raw image. Their sum fits in a 16-bit element, and
// kMostWay times the longest stride fits in 15 bits.
constexpr std::int32_t kMostWay = 10;
constexpr std::int32_t kMostOutside = 20;
static_assert((kMostWay + 1 + kMostOutside) << kRowBits < 1 << 15);

constexpr std::int64_t pair_of(double x, double y) {
  return round_to<std::int64_t>(x * 65536) * (std::int64_t{1} << 32) + round_to<std::int64_t>(y * 65536);
}
std::int64_t pair_of(const Vector2& v) { return pair_of(v.x(), v.y()); }

constexpr std::int16_t to_step(std::int32_t q16) {
  return static_cast<std::int16_t>((q16 + (1 << (kRowShift - 1))) >> kRowShift);
}

// The last bits of x and y of a cell's position (units of 2^-16 px) store its kind. Plain: the cell is
// complete, and its rows fit the 16-bit elements. Near: plain, and its pixels have nearly the same
// arrangement in the raw image (NearCell). Shifted: near, and all its pixels have the same whole-pixel
// offset.
constexpr std::int64_t kKinds = (std::int64_t{1} << 32) + 1;
constexpr std::int64_t kPlain = 1;
constexpr std::int64_t kNear = kKinds;
constexpr std::int64_t kShifted = std::int64_t{1} << 32;

constexpr std::int16_t kWeightOne = 1 << kWeightBits;
constexpr std::int16_t kWeightMask = kWeightOne - 1;

// Bilinear interpolation at (x, y), in 2^-7 px relative to the pixel `from`.
std::uint8_t blend(const std::uint8_t* from, std::ptrdiff_t stride, std::int32_t x, std::int32_t y) {
  const std::uint8_t* const above = from + (y >> kWeightBits) * stride + (x >> kWeightBits);
  const std::uint8_t* const below = above + stride;
  const std::int32_t fx = x & kWeightMask;
  const std::int32_t upper = (above[0] << kWeightBits) + (above[1] - above[0]) * fx;
  const std::int32_t lower = (below[0] << kWeightBits) + (below[1] - below[0]) * fx;
  // Computes half of the change first, as blend_eight does to fit 16-bit elements.
  const std::int32_t half = ((lower - upper) * (y & kWeightMask)) >> (kWeightBits + 1);
  return static_cast<std::uint8_t>((upper + 2 * half + kWeightOne / 2) >> kWeightBits);
}

// Two adjacent pixels, the left one in the low byte.
std::int16_t pair_at(const std::uint8_t* p) { return static_cast<std::int16_t>(p[0] | p[1] << 8); }

// Vertical step of blend for eight pixels. upper and lower are the rows after horizontal blending, times 2^7.
inline __attribute__((always_inline)) void blend_rows(const Int16x8& upper, const Int16x8& lower,
                                                      const Int16x8& fy, std::uint8_t* out) {
  Int16x8 half;
  multiply_high(lower - upper, fy * std::int16_t{256}, half);
  store_bytes((upper + half + half + kWeightOne / 2) >> kWeightBits, out);
}

// Blends eight adjacent pixels of the row that starts at `from`. x and y are offsets in 2^-7 px, from 0 to
// below 2 px; to below 1 px for a shifted cell.
template <bool kIsShifted>
inline __attribute__((always_inline)) void blend_near(const std::uint8_t* from, std::ptrdiff_t stride,
                                                      const Int16x8& x, const Int16x8& y, std::uint8_t* out) {
#ifdef PLVO_SIMD_LOOPS
  for (int i = 0; i < 8; ++i) out[i] = blend(from, stride, x[i] + i * kWeightOne, y[i]);
#else
  if constexpr (kIsShifted) {
    const Int16x8 left = kWeightOne - x;
    const auto along = [&](const std::uint8_t* row) {
      Int16x8 a, b;
      load_bytes(row, a);
      load_bytes(row + 1, b);
      return a * left + b * x;
    };
    blend_rows(along(from), along(from + stride), y, out);
    return;
  }
  // Avoids a load per pixel: reads three pixels in each of three rows. One of the three has weight 0.
  const Int16x8 beyond = x - kWeightOne;
  const Int16x8 last = beyond > 0 ? beyond : Int16x8{};
  const Int16x8 first = last - beyond;
  const Int16x8 middle = kWeightOne - first - last;
  const auto along = [&](const std::uint8_t* row) {
    Int16x8 a, b, c;
    load_bytes(row, a);
    load_bytes(row + 1, b);
    load_bytes(row + 2, c);
    return a * first + b * middle + c * last;
  };
  const Int16x8 top = along(from), centre = along(from + stride), bottom = along(from + 2 * stride);
  const Int16x8 is_below = y >= kWeightOne;
  blend_rows(is_below ? centre : top, is_below ? bottom : centre, y & kWeightMask, out);
#endif
}

// Blends eight pixels at positions in 2^-7 px relative to the pixel `from`.
void blend_eight(const std::uint8_t* from, std::ptrdiff_t stride, const Int16x8& x, const Int16x8& y,
                 std::uint8_t* out) {
  if constexpr (kSimdLoops) {
    for (int i = 0; i < 8; ++i) out[i] = blend(from, stride, x[i], y[i]);
    return;
  }
  const Int16x8 offsets = (y >> kWeightBits) * static_cast<std::int16_t>(stride) + (x >> kWeightBits);
  alignas(16) std::int16_t offset[8];
  store(offsets, offset);
  const std::uint8_t* const from_below = from + stride;
  Int16x8 above, below;
  for (int i = 0; i < 8; ++i) {
    above[i] = pair_at(from + offset[i]);
    below[i] = pair_at(from_below + offset[i]);
  }
  const Int16x8 fx = x & kWeightMask;
  const Int16x8 upper_left = above & 255;
  const Int16x8 lower_left = below & 255;
  const Int16x8 upper = upper_left * kWeightOne + (((above >> 8) & 255) - upper_left) * fx;
  const Int16x8 lower = lower_left * kWeightOne + (((below >> 8) & 255) - lower_left) * fx;
  blend_rows(upper, lower, y & kWeightMask, out);
}

}  // namespace

// A cell that the distortion hardly rotates or scales. Each pixel is read less than 2 px to the right of and
// below the pixel with the same index in a cell of the raw image. The offsets are 16-bit integers in 2^-13
// px.
struct UndistortionMap::NearCell {
  static constexpr int kBits = 13;
  static constexpr int kToWeight = kBits - kWeightBits;
  static constexpr std::int32_t kHalf = 1 << (kFractionBits - 1);
  static constexpr std::int16_t kRound = 1 << (kToWeight - 1);
  static constexpr std::int16_t element(std::int32_t q16) {
    constexpr int kShift = kFractionBits - kBits;
    return static_cast<std::int16_t>((q16 + (1 << (kShift - 1))) >> kShift);
  }

  // One axis, x or y: the offsets of the first row's pixels and their change per row.
  struct Axis {
    std::int32_t base;  // first column or row of the raw cell
    std::int16_t bend;
    Int16x8 first, step;

    __attribute__((always_inline)) Axis(std::int32_t at, std::int32_t right, std::int32_t down,
                                        std::int32_t twist, std::int32_t bend_right, std::int32_t bend_down)
        : base((at - kHalf) >> kFractionBits), bend(element(bend_down)) {
      constexpr Int16x8 kSteps = {0, 1, 2, 3, 4, 5, 6, 7};
      constexpr Int16x8 kBows = {bow(0), bow(1), bow(2), bow(3), bow(4), bow(5), bow(6), bow(7)};
      first = kSteps * element(right) + kBows * element(bend_right) +
              static_cast<std::int16_t>(element(at - (base << kFractionBits)) + kRound);
      step = kSteps * element(twist) + element(down);
    }
    // For a shifted cell: moves the whole-pixel part of the offsets, which all pixels share, into base.
    __attribute__((always_inline)) void shift() {
      const int whole = first[0] >> kBits;
      base += whole;
      first = first - static_cast<std::int16_t>(whole << kBits);
    }
    // Offsets of row j, in 2^-7 px.
    __attribute__((always_inline)) void of_row(int j, Int16x8& out) const {
      out = (first + step * static_cast<std::int16_t>(j) + static_cast<std::int16_t>(bow(j) * bend)) >>
            kToWeight;
    }
  };

  static constexpr std::int32_t kOne = 1 << kFractionBits;
  __attribute__((always_inline)) explicit NearCell(const Cell& c)
      : x(x_of(place(c)), x_of(c.right) - kOne, x_of(c.down), x_of(c.twist), x_of(c.bend_right),
          x_of(c.bend_down)),
        y(y_of(place(c)), y_of(c.right), y_of(c.down) - kOne, y_of(c.twist), y_of(c.bend_right),
          y_of(c.bend_down)) {}
  Axis x, y;
};

void UndistortionMap::init(const CameraModel& camera) {
  width_ = camera.width;
  height_ = camera.height;
  active_ = !camera.distortion.is_zero();
  if (!active_) return;
  columns_ = cells_along(width_);
  last_x_ = ((width_ - 1) << kFractionBits) - 1;
  last_y_ = ((height_ - 1) << kFractionBits) - 1;
  const auto rows = static_cast<int>(cells_along(height_));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < static_cast<int>(columns_); ++column) {
      const auto at = [&](int i, int j) {
        // Clamps positions that lie outside by more than the largest image size.
        const Vector2 p = distort_pixel(
            camera, {static_cast<double>(kCell * column + i), static_cast<double>(kCell * row + j)});
        return Vector2(std::clamp<double>(p.x(), -kMaxSide, 2 * kMaxSide),
                       std::clamp<double>(p.y(), -kMaxSide, 2 * kMaxSide));
      };
      constexpr int kHalf = kCell / 2;
      constexpr double kSag = 2.0 * static_cast<double>(bow(kHalf));
      const Vector2 a = at(0, 0), b = at(kCell, 0), c = at(0, kCell), d = at(kCell, kCell);
      const Vector2 corners = 0.5 * (a + b + c + d);
      Cell& cell = cells_[static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column)];
      cell = {pair_of(a),
              pair_of((b - a) / kCell),
              pair_of((c - a) / kCell),
              pair_of((d - c - b + a) / (kCell * kCell)),
              pair_of((at(kHalf, 0) + at(kHalf, kCell) - corners) / kSag),
              pair_of((at(0, kHalf) + at(kCell, kHalf) - corners) / kSag)};
      cell.at &= ~kKinds;
      if (kCell * (column + 1) > width_ || !is_plain(cell)) continue;
      cell.at |= kNear;
      bool shifted = false;
      if (!is_near(cell, shifted))
        cell.at ^= kNear ^ kPlain;
      else if (shifted)
        cell.at ^= kNear ^ kShifted;
    }
  }
}

bool UndistortionMap::is_plain(const Cell& c) const {
  constexpr std::int32_t kMost = kMostWay << kFractionBits;
  for (int j = 0; j < kCell; ++j)
    for (int i = 0; i < kCell; ++i) {
      const std::int64_t way = i * (c.right + j * c.twist) + bow(i) * c.bend_right;
      if (std::max({x_of(way), -x_of(way), y_of(way), -y_of(way)}) > kMost) return false;
    }
  return true;
}

bool UndistortionMap::is_near(const Cell& c, bool& shifted) const {
  constexpr int kMost = 2 * kWeightOne;
  const NearCell near(c);
  shifted = true;
  if (near.x.base < 0 || near.y.base < 0 || near.x.base + kCell + 2 > width_ ||
      near.y.base + kCell + 2 > height_)
    return false;
  for (int j = 0; j < kCell; ++j) {
    Int16x8 x, y;
    near.x.of_row(j, x);
    near.y.of_row(j, y);
    for (int i = 0; i < kCell; ++i) {
      // Compares with the map itself, because the 16-bit values may have overflowed.
      const std::int64_t at = position(c, i, j);
      const auto close = [](std::int32_t q16, int whole, int weight) {
        const int off = (q16 >> (kFractionBits - kWeightBits)) - (whole << kWeightBits) - weight;
        return off >= -2 && off <= 2;
      };
      if (x[i] < 0 || y[i] < 0 || x[i] >= kMost || y[i] >= kMost || !close(x_of(at), near.x.base + i, x[i]) ||
          !close(y_of(at), near.y.base + j, y[i]))
        return false;
      if (x[i] >> kWeightBits != near.x.first[0] >> NearCell::kBits ||
          y[i] >> kWeightBits != near.y.first[0] >> NearCell::kBits)
        shifted = false;
    }
  }
  return true;
}

// Undistorts rows of a near cell. Each reads three rows of the raw image, or two if the cell is shifted.
template <bool kIsShifted>
void UndistortionMap::undistort_near(const Cell& cell, int first, int last, GrayView raw, std::uint8_t* out,
                                     std::ptrdiff_t out_stride) {
  NearCell near(cell);
  if (kIsShifted) {
    near.x.shift();
    near.y.shift();
  }
  const std::uint8_t* const from = raw.data + near.y.base * raw.stride + near.x.base;
  const auto undistort_row = [&](int j) __attribute__((always_inline)) {
    Int16x8 x, y;
    near.x.of_row(j, x);
    near.y.of_row(j, y);
    blend_near<kIsShifted>(from + j * raw.stride, raw.stride, x, y, out + (j - first) * out_stride);
  };
  // With constant row numbers, the products with them become constants.
  if (!kSimdLoops && first == 0 && last == kCell) {
#pragma GCC unroll 8
    for (int j = 0; j < kCell; ++j) undistort_row(j);
    return;
  }
  for (int j = first; j < last; ++j) undistort_row(j);
}

// One axis of a row of a plain cell: the position of the first pixel and the clamping limits of all eight.
// Both are relative to the raw pixel `base`, which contains the first pixel or is the nearest pixel of the
// border.
struct UndistortionMap::PlainStart {
  std::int32_t base;
  std::int16_t at;         // 2^-10 px
  std::int16_t low, high;  // 2^-7 px

  __attribute__((always_inline)) PlainStart(std::int32_t q16, std::int32_t last)
      : base(std::clamp<std::int32_t>(q16 >> kFractionBits, 0, last >> kFractionBits)) {
    constexpr std::int32_t kMost = kMostOutside << kFractionBits;
    at = static_cast<std::int16_t>(std::clamp<std::int32_t>(q16 - (base << kFractionBits), -kMost, kMost) >>
                                   kRowShift);
    low = static_cast<std::int16_t>(std::max<std::int32_t>(-base * kWeightOne, INT16_MIN));
    high = static_cast<std::int16_t>(
        std::min<std::int32_t>((last >> (kFractionBits - kWeightBits)) - base * kWeightOne, INT16_MAX));
  }
};

// Undistorts rows of a plain cell, eight pixels at once. Positions are clamped to the raw image.
void UndistortionMap::undistort_plain(const Cell& cell, int first, int last, GrayView raw, std::uint8_t* out,
                                      std::ptrdiff_t out_stride) const {
  const Cell c = cell;  // a local copy, which writes to out cannot alias
  constexpr Int16x8 kSteps = {0, 1, 2, 3, 4, 5, 6, 7};
  constexpr Int16x8 kBows = {bow(0), bow(1), bow(2), bow(3), bow(4), bow(5), bow(6), bow(7)};
  constexpr int kToWeight = kRowBits - kWeightBits;
  constexpr std::int16_t kRound = 1 << (kToWeight - 1);
  const Int16x8 bent_x = kBows * to_step(x_of(c.bend_right)) + kRound;
  const Int16x8 bent_y = kBows * to_step(y_of(c.bend_right)) + kRound;
  for (int j = first; j < last; ++j, out += out_stride) {
    const std::int64_t start = c.at + j * c.down + bow(j) * c.bend_down;
    const std::int64_t right = c.right + j * c.twist;
    const PlainStart x(x_of(start), last_x_), y(y_of(start), last_y_);
    Int16x8 at_x = (kSteps * to_step(x_of(right)) + bent_x + x.at) >> kToWeight;
    Int16x8 at_y = (kSteps * to_step(y_of(right)) + bent_y + y.at) >> kToWeight;
    clamp(x.low, x.high, at_x);
    clamp(y.low, y.high, at_y);
    blend_eight(raw.data + y.base * raw.stride + x.base, raw.stride, at_x, at_y, out);
  }
}

// Undistorts rows of any cell, pixel by pixel.
void UndistortionMap::undistort_each(const Cell& cell, int first, int last, GrayView raw, int count,
                                     std::uint8_t* out, std::ptrdiff_t out_stride) const {
  const Cell c = cell;
  constexpr int kToWeight = kFractionBits - kWeightBits;
  for (int j = first; j < last; ++j, out += out_stride) {
    const std::int64_t right = c.right + j * c.twist;
    std::int64_t start = c.at + j * c.down + bow(j) * c.bend_down;
    for (int i = 0; i < count; ++i, start += right) {
      const std::int64_t at = start + bow(i) * c.bend_right;
      out[i] = blend(raw.data, raw.stride, std::clamp<std::int32_t>(x_of(at), 0, last_x_) >> kToWeight,
                     std::clamp<std::int32_t>(y_of(at), 0, last_y_) >> kToWeight);
    }
  }
}

void UndistortionMap::undistort(GrayView raw, ImageView<std::uint8_t> ideal, int begin, int end) const {
  // Works cell by cell, so that values common to its rows are computed once.
  for (int top = begin - begin % kCell; top < end; top += kCell) {
    const int first = std::max(begin - top, 0);
    const int last = std::min(end - top, kCell);
    for (int x = 0; x < width_; x += kCell) {
      const Cell& c = cell(x, top);
      std::uint8_t* const out = ideal.row(top + first) + x;
      const std::int64_t kind = c.at & kKinds;
      if (kind == kShifted && !kSimdLoops)
        undistort_near<true>(c, first, last, raw, out, ideal.stride);
      else if (kind == kShifted || kind == kNear)
        undistort_near<false>(c, first, last, raw, out, ideal.stride);
      else if (kind == kPlain)
        undistort_plain(c, first, last, raw, out, ideal.stride);
      else
        undistort_each(c, first, last, raw, std::min(kCell, width_ - x), out, ideal.stride);
    }
  }
}

}  // namespace plvo
