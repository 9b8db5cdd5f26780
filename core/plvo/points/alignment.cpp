// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/alignment.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "plvo/base/bits.hpp"
#include "plvo/base/build.hpp"
#include "plvo/base/simd.hpp"
#include "plvo/math/cholesky.hpp"
#include "plvo/math/rounding.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

// Eight columns and nine rows. Eight 16-bit numbers fill one SIMD register.
constexpr int kColumns = kWindowColumns;
constexpr int kRows = kWindowRows;
constexpr int kPixels = kColumns * kRows;
constexpr int kLeastPixels = kPixels / 3;
// Early rejection: after the first step, the residual of a visible patch is at most this multiple of the
// final limit. At most three in ten thousand patches that end well exceed it on the way.
constexpr double kHopeless = 3;
constexpr int kFractionBits = 5;  // positions are read on a grid of 1/32 px
constexpr int kTaps = 4;          // taps of the cubic B-spline

// The spline's weights at every fraction, in 1/128. Their sum is exactly 128 and their centroid exactly the
// fraction: the outer two are rounded, and the inner two follow from them. A wrong centroid would move all
// points that are read at that fraction.
using Weights = std::array<std::int16_t, kTaps>;
constexpr std::array<Weights, 1 << kFractionBits> make_weights() {
  std::array<Weights, 1 << kFractionBits> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double f = static_cast<double>(i) / (1 << kFractionBits);
    const double g = 1 - f;
    const int before = static_cast<int>(g * g * g / 6 * 128 + 0.5);
    const int behind = static_cast<int>(f * f * f / 6 * 128 + 0.5);
    const int right = static_cast<int>(128 * f) + before - 2 * behind;
    const int left = 128 - before - right - behind;
    table[i] = {static_cast<std::int16_t>(before), static_cast<std::int16_t>(left),
                static_cast<std::int16_t>(right), static_cast<std::int16_t>(behind)};
  }
  return table;
}
constexpr auto kWeights = make_weights();

// The four regressors of the smoothed template, in 1/16 of a grey level: 2·∂T/∂x, 2·∂T/∂y, T minus its mean,
// and the constant one. All are zero outside of the mask. normal: their normal equations, in grey levels.
struct Template {
  std::array<std::int16_t, kPixels> gx, gy, value, one;
  Matrix4 normal;
};
constexpr double kValueUnit = 1.0 / 16;

// Largest stretch or shrinkage of a patch. Beyond it, the patch no longer looks the same.
constexpr double kMostStretch = 3;

// Horizontal pass, eight pixels at once. Grey levels have eight bits and the weights seven. The first pass
// rounds to four fraction bits, and so does the second. No weighted sum exceeds 255 · 128.
void blend_across(const std::uint8_t* p, const Weights& w, std::int16_t* out) {
  Int16x8 tap[kTaps];
  for (int i = 0; i < kTaps; ++i) load_bytes(p + i, tap[i]);
  const Int16x8 blended =
      (tap[0] * w[0] + tap[1] * w[1] + tap[2] * w[2] + tap[3] * w[3] + std::int16_t{4}) >> 3;
  store(blended, out);
}
[[maybe_unused]] std::int16_t blend_down(const std::int16_t* p, int stride, const Weights& w) {
  return static_cast<std::int16_t>(
      (p[0] * w[0] + p[stride] * w[1] + p[2 * stride] * w[2] + p[3 * stride] * w[3] + 64) >> 7);
}

// Vertical pass over eight columns at once, in 32 bits.
struct DownWeights {
  Int16x8 upper, lower;  // weights of adjacent taps, in pairs
  explicit DownWeights(const Weights& w)
      : upper{w[0], w[1], w[0], w[1], w[0], w[1], w[0], w[1]}, lower{w[2], w[3], w[2], w[3],
                                                                     w[2], w[3], w[2], w[3]} {}
};
inline __attribute__((always_inline)) void blend_down(const Int16x8 taps[kTaps], const DownWeights& weights,
                                                      Int16x8& out) {
  Int16x8 upper[2], lower[2];
  interleave(taps[0], taps[1], upper[0], upper[1]);
  interleave(taps[2], taps[3], lower[0], lower[1]);
  Int32x4 sums[2];
  for (int i = 0; i < 2; ++i) {
    Int32x4 above, below;
    dot_pairs(upper[i], weights.upper, above);
    dot_pairs(lower[i], weights.lower, below);
    sums[i] = (above + below + 64) >> 7;
  }
  narrow(sums[0], sums[1], out);
}

int pixels_of(const WindowMask& mask) {
  std::uint64_t eight_rows;
  static_assert(kRows == 9);
  std::memcpy(&eight_rows, mask.data(), sizeof eight_rows);
  return count_bits(eight_rows) + count_bits(mask[8]);
}

// Maps the pixels of a slightly warped window to the template: pixel (dx, dy) of the window is displaced by
// (W⁻¹ − I) (dx, dy). The coefficients are in 2^-kMoveBits px per pixel from the centre.
class WindowMove {
 public:
  explicit WindowMove(const Matrix2& W) {
    const double scale = (1 << kMoveBits) / (W(0, 0) * W(1, 1) - W(0, 1) * W(1, 0));
    constexpr double kOne = 1 << kMoveBits;
    across_x_ = round_to<std::int16_t>(W(1, 1) * scale - kOne);
    down_x_ = round_to<std::int16_t>(-W(0, 1) * scale);
    across_y_ = round_to<std::int16_t>(-W(1, 0) * scale);
    down_y_ = round_to<std::int16_t>(W(0, 0) * scale - kOne);
  }

  bool is_none() const { return across_x_ == 0 && down_x_ == 0 && across_y_ == 0 && down_y_ == 0; }

  // Adds the first-order change to a row of the window. gx and gy are twice the gradient, in the unit of the
  // values. A value of at most 255 · 16 stays within 4800: a pixel that is raised by a neighbour was itself
  // low.
  void add_change(std::size_t row, const Int16x8& gx, const Int16x8& gy, Int16x8& values) const {
    constexpr Int16x8 kAcross = {-4, -3, -2, -1, 0, 1, 2, 3};
    static_assert(kWindowReach == 4);
    const auto down = static_cast<std::int16_t>(static_cast<int>(row) - kWindowReach);
    const Int16x8 dx = kAcross * across_x_ + static_cast<std::int16_t>(down_x_ * down);
    const Int16x8 dy = kAcross * across_y_ + static_cast<std::int16_t>(down_y_ * down);
    Int16x8 gradient[2], offset[2];
    interleave(gx, gy, gradient[0], gradient[1]);
    interleave(dx, dy, offset[0], offset[1]);
    Int32x4 change[2];
    for (int i = 0; i < 2; ++i) {
      dot_pairs(gradient[i], offset[i], change[i]);
      change[i] = (change[i] + (1 << kMoveBits)) >> (kMoveBits + 1);
    }
    Int16x8 eight;
    narrow(change[0], change[1], eight);
    values = values + eight;
  }

 private:
  static constexpr int kMoveBits = 12;
  std::int16_t across_x_, down_x_, across_y_, down_y_;
};

// Computes the patch as the spline reads it at whole pixels, and the spline's gradient there. The gradient is
// the difference of the two neighbours along its own direction, smoothed across it.
Template make_template(const Patch& patch, const WindowMask& mask, const WindowMove& move) {
  constexpr const Weights& kWhole = kWeights[0];
  static_assert(kWhole[0] == kWhole[2] && kWhole[3] == 0);
  Int16x8 smoothed[kRows + kTaps - 1] = {}, difference[kRows + 2];
  const std::uint8_t* p = patch.data() + (kPatchRadius - kWindowReach - 1) * (kPatchSide + 1) + 1;
  for (std::size_t y = 0; y < kRows + 2; ++y, p += kPatchSide) {
    Int16x8 left, here, right;
    load_bytes(p - 1, left);
    load_bytes(p, here);
    load_bytes(p + 1, right);
    smoothed[y] = ((left + right) * kWhole[0] + here * kWhole[1] + std::int16_t{4}) >> 3;
    difference[y] = right - left;
  }
  Template t;
  const DownWeights down(kWhole);
  constexpr Int16x8 kBits = {1, 2, 4, 8, 16, 32, 64, 128};
  Int32x4 total = {};
  for (std::size_t y = 0; y < kRows; ++y) {
    const Int16x8 on = (kBits & static_cast<std::int16_t>(mask[y])) != 0;  // all bits of an element, or none
    const Int16x8 one = on & std::int16_t{1};
    const Int16x8 gx =
        ((difference[y] + difference[y + 2]) * kWhole[0] + difference[y + 1] * kWhole[1] + std::int16_t{4}) >>
        3;
    const Int16x8 gy = smoothed[y + 2] - smoothed[y];
    Int16x8 value;
    blend_down(&smoothed[y], down, value);
    if (!move.is_none()) move.add_change(y, gx, gy, value);
    Int32x4 sums;
    dot_pairs(value, one, sums);
    total += sums;
    const std::size_t first = y * kColumns;
    store(on & gx, &t.gx[first]);
    store(on & gy, &t.gy[first]);
    store(value, &t.value[first]);
    store(one, &t.one[first]);
  }
  // With the mean removed, the grey levels are orthogonal to the constant, so gain and offset separate well.
  const auto mean = static_cast<std::int16_t>((total[0] + total[1] + total[2] + total[3]) / pixels_of(mask));
  for (std::size_t k = 0; k < kPixels; ++k)
    t.value[k] = static_cast<std::int16_t>((t.value[k] - mean) * t.one[k]);
  std::int32_t gx_gx = 0, gx_gy = 0, gx_value = 0, gy_gy = 0, gy_value = 0, value_value = 0;
  for (std::size_t k = 0; k < kPixels; ++k) {
    gx_gx += t.gx[k] * t.gx[k];
    gx_gy += t.gx[k] * t.gy[k];
    gx_value += t.gx[k] * t.value[k];
    gy_gy += t.gy[k] * t.gy[k];
    gy_value += t.gy[k] * t.value[k];
    value_value += t.value[k] * t.value[k];
  }
  std::int32_t gx_one = 0, gy_one = 0, value_one = 0, one_one = 0;
  for (std::size_t k = 0; k < kPixels; ++k) {
    gx_one += t.gx[k] * t.one[k];
    gy_one += t.gy[k] * t.one[k];
    value_one += t.value[k] * t.one[k];
    one_one += t.one[k] * t.one[k];
  }
  const std::int32_t sums[4][4] = {{gx_gx, gx_gy, gx_value, gx_one},
                                   {gx_gy, gy_gy, gy_value, gy_one},
                                   {gx_value, gy_value, value_value, value_one},
                                   {gx_one, gy_one, value_one, one_one}};
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      t.normal(r, c) = (r < 3 ? kValueUnit : 1) * (c < 3 ? kValueUnit : 1) * sums[r][c];
  return t;
}

struct Moments {
  Vector4 with_template = Vector4::Zero();  // Σ I · regressors
  double squared = 0;                       // Σ I²
};

using PatchWindow = std::array<std::int16_t, kPixels>;
constexpr std::int32_t kOnePixel = 1 << kFractionBits;

// (x, y): the position of the patch's centre, in 1/32 px. The window must lie inside the image.
PatchWindow read_window(GrayView image, std::int32_t x, std::int32_t y) {
  const Weights& across = kWeights[static_cast<std::size_t>(x & (kOnePixel - 1))];
  const Weights& down = kWeights[static_cast<std::size_t>(y & (kOnePixel - 1))];
  const std::uint8_t* first = image.data + ((y >> kFractionBits) - kWindowReach - 1) * image.stride +
                              (x >> kFractionBits) - kWindowReach - 1;
  constexpr int kBlendedRows = kRows + kTaps - 1;
  std::array<std::int16_t, kColumns * kBlendedRows> blended;
  for (int r = 0; r < kBlendedRows; ++r) {
    static_assert(kColumns * sizeof(std::int16_t) == sizeof(Int16x8));
    blend_across(first + r * image.stride, across, &blended[static_cast<std::size_t>(r * kColumns)]);
  }
  PatchWindow values;
  if constexpr (kSimdLoops) {
    for (std::size_t k = 0; k < kPixels; ++k) values[k] = blend_down(&blended[k], kColumns, down);
    return values;
  }
  const DownWeights weights(down);
  for (std::size_t k = 0; k < kPixels; k += kColumns) {
    Int16x8 taps[kTaps], out;
    for (std::size_t tap = 0; tap < kTaps; ++tap) load(&blended[k + tap * kColumns], taps[tap]);
    blend_down(taps, weights, out);
    store(out, &values[k]);
  }
  return values;
}

// Offsets of the warped window's pixels from the patch's centre, in 1/32 px.
struct WarpedWindow {
  std::array<std::int16_t, kPixels> x, y;
  int reach = kWindowReach;  // upper bound of the offsets, px
};

std::int16_t rounded(double offset) {
  constexpr int kBeyond = 1 << 14;  // larger than any offset, so that truncation rounds down
  return static_cast<std::int16_t>(static_cast<int>(offset + 0.5 + kBeyond) - kBeyond);
}

[[maybe_unused]] WarpedWindow warp_each(const PatchWarp& warp) {
  WarpedWindow window;
  std::size_t i = 0;
  int farthest = 0;
  for (int row = -kWindowReach; row < kRows - kWindowReach; ++row)
    for (int column = -kWindowReach; column < kColumns - kWindowReach; ++column, ++i) {
      const Vector2 at = kOnePixel * (warp.W * Vector2(column, row));
      window.x[i] = rounded(at.x());
      window.y[i] = rounded(at.y());
      for (const int offset : {static_cast<int>(window.x[i]), static_cast<int>(window.y[i])})
        farthest = std::max(farthest, offset < 0 ? -offset : offset);
    }
  window.reach = farthest / kOnePixel + 1;
  return window;
}

// Same result as warp_each. Scaling by a power of two commutes with the sum, and the largest offset is at a
// corner because rounding is monotonic.
WarpedWindow warp_window(const PatchWarp& warp) {
  if constexpr (kSimdLoops) return warp_each(warp);
  WarpedWindow window;
  std::array<double, kColumns> across_x, across_y;
  for (int i = 0; i < kColumns; ++i) {
    across_x[static_cast<std::size_t>(i)] = kOnePixel * warp.W(0, 0) * (i - kWindowReach);
    across_y[static_cast<std::size_t>(i)] = kOnePixel * warp.W(1, 0) * (i - kWindowReach);
  }
  for (std::size_t row = 0; row < kRows; ++row) {
    const double down_x = kOnePixel * warp.W(0, 1) * (static_cast<int>(row) - kWindowReach);
    const double down_y = kOnePixel * warp.W(1, 1) * (static_cast<int>(row) - kWindowReach);
    for (std::size_t i = 0; i < kColumns; ++i) window.x[row * kColumns + i] = rounded(across_x[i] + down_x);
    for (std::size_t i = 0; i < kColumns; ++i) window.y[row * kColumns + i] = rounded(across_y[i] + down_y);
  }
  int farthest = 0;
  constexpr std::size_t kCorners[] = {0, kColumns - 1, kPixels - kColumns, kPixels - 1};
  for (const std::size_t i : kCorners)
    for (const int offset : {static_cast<int>(window.x[i]), static_cast<int>(window.y[i])})
      farthest = std::max(farthest, offset < 0 ? -offset : offset);
  window.reach = farthest / kOnePixel + 1;
  return window;
}

// Reads each pixel at its own fraction: down its four columns, then across.
[[maybe_unused]] PatchWindow read_each(GrayView image, const WarpedWindow& window, std::int32_t x,
                                       std::int32_t y) {
  PatchWindow values;
  for (std::size_t k = 0; k < kPixels; ++k) {
    const std::int32_t at_x = x + window.x[k];
    const std::int32_t at_y = y + window.y[k];
    const std::uint8_t* p =
        image.data + ((at_y >> kFractionBits) - 1) * image.stride + (at_x >> kFractionBits) - 1;
    const Weights& down = kWeights[static_cast<std::size_t>(at_y & (kOnePixel - 1))];
    const Weights& across = kWeights[static_cast<std::size_t>(at_x & (kOnePixel - 1))];
    std::int32_t sum = 64;
    for (std::size_t c = 0; c < kTaps; ++c) {
      std::int32_t column = 4;
      for (std::size_t r = 0; r < kTaps; ++r)
        column += p[static_cast<std::ptrdiff_t>(r) * image.stride + static_cast<std::ptrdiff_t>(c)] * down[r];
      sum += (column >> 3) * across[c];
    }
    values[k] = static_cast<std::int16_t>(sum >> 7);
  }
  return values;
}

// Each weight four times, once for each of a pixel's four columns.
alignas(16) constexpr auto kColumnWeights = [] {
  std::array<std::array<std::array<std::int16_t, kTaps>, kTaps>, 1 << kFractionBits> table{};
  for (std::size_t i = 0; i < table.size(); ++i)
    for (std::size_t tap = 0; tap < kTaps; ++tap) table[i][tap].fill(kWeights[i][tap]);
  return table;
}();

// Reads two pixels. Each column sum adds rows that are two apart, then both halves; the weights across
// follow. halves: two partial sums per pixel.
inline __attribute__((always_inline)) void read_two(const std::uint8_t* const p[2], std::ptrdiff_t stride,
                                                    const std::int16_t* across, const std::int16_t* down,
                                                    Int32x4& halves) {
  Int16x8 columns[2];
  for (int i = 0; i < 2; ++i) {
    const std::uint8_t* const rows[kTaps] = {p[i], p[i] + stride, p[i] + 2 * stride, p[i] + 3 * stride};
    const auto& weights = kColumnWeights[static_cast<std::size_t>(down[i])];
    Int16x8 first, last, upper, lower;
    load_bytes(rows, first, last);
    load(weights[0].data(), upper);
    load(weights[2].data(), lower);
    columns[i] = first * upper + last * lower;
  }
  Int16x8 sum, weights;
  add_halves(columns[0], columns[1], sum);
  sum = (sum + std::int16_t{4}) >> 3;
  load_halves(kWeights[static_cast<std::size_t>(across[0])].data(),
              kWeights[static_cast<std::size_t>(across[1])].data(), weights);
  dot_pairs(sum, weights, halves);
}

// Same result as read_each, one row of the window at a time.
PatchWindow read_warped(GrayView image, const WarpedWindow& window, std::int32_t x, std::int32_t y) {
  if constexpr (kSimdLoops) return read_each(image, window, x, y);
  constexpr std::int16_t kFraction = kOnePixel - 1;
  const std::uint8_t* const from =
      image.data + ((y >> kFractionBits) - 1) * image.stride + (x >> kFractionBits) - 1;
  const auto fraction_x = static_cast<std::int16_t>(x & kFraction);
  const auto fraction_y = static_cast<std::int16_t>(y & kFraction);
  const auto stride = static_cast<std::int16_t>(image.stride);
  const Int16x8 steps = {stride, 1, stride, 1, stride, 1, stride, 1};
  PatchWindow values;
  for (std::size_t row = 0; row < kPixels; row += kColumns) {
    Int16x8 at_x, at_y;
    load(&window.x[row], at_x);
    load(&window.y[row], at_y);
    at_x = at_x + fraction_x;
    at_y = at_y + fraction_y;
    const Int16x8 whole_x = at_x >> kFractionBits;
    const Int16x8 whole_y = at_y >> kFractionBits;
    Int16x8 first, last;
    interleave(whole_y, whole_x, first, last);
    Int32x4 four;
    alignas(16) std::int32_t offset[kColumns];
    dot_pairs(first, steps, four);
    store(four, offset);
    dot_pairs(last, steps, four);
    store(four, offset + 4);
    alignas(16) std::int16_t across[kColumns], down[kColumns];
    const Int16x8 part_x = at_x & kFraction;
    const Int16x8 part_y = at_y & kFraction;
    store(part_x, across);
    store(part_y, down);
    Int32x4 read[2];
    for (int i = 0; i < kColumns; i += 4) {
      const std::uint8_t* const p[4] = {from + offset[i], from + offset[i + 1], from + offset[i + 2],
                                        from + offset[i + 3]};
      Int32x4 halves[2];
      read_two(p, image.stride, across + i, down + i, halves[0]);
      read_two(p + 2, image.stride, across + i + 2, down + i + 2, halves[1]);
      Int32x4 sums;
      add_pairs(halves[0], halves[1], sums);
      read[i / 4] = (sums + 64) >> 7;
    }
    Int16x8 eight;
    narrow(read[0], read[1], eight);
    store(eight, &values[row]);
  }
  return values;
}

Moments correlate(const Template& t, const PatchWindow& values) {
  // 72 products of at most 4080 with a template value of at most 4800 stay below 2^31. So do 72 squares of
  // 4080.
  std::int32_t with_gx = 0;
  std::int32_t with_gy = 0;
  std::int32_t with_value = 0;
  std::int32_t sum = 0;
  std::int32_t squared = 0;
  for (std::size_t k = 0; k < kPixels; ++k) {
    with_gx += values[k] * t.gx[k];
    with_gy += values[k] * t.gy[k];
    with_value += values[k] * t.value[k];
    sum += values[k] * t.one[k];
    squared += values[k] * static_cast<std::int16_t>(values[k] * t.one[k]);
  }
  Moments moments;
  moments.with_template << kValueUnit * kValueUnit * with_gx, kValueUnit * kValueUnit * with_gy,
      kValueUnit * kValueUnit * with_value, kValueUnit * sum;
  moments.squared = kValueUnit * kValueUnit * static_cast<double>(squared);
  return moments;
}

}  // namespace

// Limit of the displacement of any pixel of the window along x or y. Within it, the error of the first-order
// approximation is at most a twentieth of the second derivative, at the rim.
bool PatchWarp::is_slight() const {
  constexpr double kMost_px = 0.3;
  return (W - Matrix2::Identity()).cwiseAbs().rowwise().sum().maxCoeff() * kWindowReach < kMost_px;
}

Alignment align_patch(const Patch& patch, const WindowMask& mask, GrayView image, double start_x,
                      double start_y, const AlignmentOptions& options, const PatchWarp& warp) {
  Alignment result;
  const int pixels = pixels_of(mask);
  if (pixels < kLeastPixels) return result;
  const Matrix2& W = warp.W;
  if (!(W.cwiseAbs().maxCoeff() < kMostStretch &&
        W(0, 0) * W(1, 1) - W(0, 1) * W(1, 0) > 1 / (kMostStretch * kMostStretch)))
    return result;
  const bool warped = !warp.is_slight();
  WarpedWindow window;
  if (warped) window = warp_window(warp);
  const Template t = make_template(patch, mask, WindowMove(warped ? Matrix2(Matrix2::Identity()) : W));
  Cholesky<4> factor;
  if (!factor.factor(t.normal)) return result;

  result.x = start_x;
  result.y = start_y;
  const double max_shift_squared = options.max_shift_px * options.max_shift_px;
  const double mean = t.normal(2, 3) / pixels;
  const double variance = t.normal(2, 2) / pixels - mean * mean;
  const double most_residual = options.max_residual * options.max_residual * variance * (pixels - 4);
  bool converged = false;
  while (!converged && result.iterations < options.max_iterations) {
    // After rounding down, the read touches one pixel before the window and two after it.
    const int first = window.reach + 2;
    if (!(result.x >= first && result.y >= first && result.x < image.width - first - 1 &&
          result.y < image.height - first - 1))
      return result;
    constexpr double kOne = kOnePixel;
    const auto x = static_cast<std::int32_t>(result.x * kOne + 0.5);
    const auto y = static_cast<std::int32_t>(result.y * kOne + 0.5);
    const Moments moments =
        correlate(t, warped ? read_warped(image, window, x, y) : read_window(image, x, y));
    const Vector4 solution = factor.solve(moments.with_template);
    ++result.iterations;
    const double gain = solution[2];
    if (!(gain > 0.2 && gain < 5)) return result;
    const double residual = moments.squared - solution.dot(moments.with_template);
    const double most_here = most_residual * gain * gain;
    if (result.iterations > 1 && !(residual <= kHopeless * most_here)) return result;
    // The regressors are twice the gradients.
    const double before_x = result.x;
    const double before_y = result.y;
    const Vector2 moved = 2 / gain * (W * solution.head<2>());
    result.x = x / kOne - moved.x();
    result.y = y / kOne - moved.y();
    const double dx = result.x - start_x;
    const double dy = result.y - start_y;
    if (!(dx * dx + dy * dy <= max_shift_squared)) return result;
    // Compares two solutions. The step of the regression itself starts on the grid of 1/32 px, not at the
    // last solution.
    const double step_x = result.x - before_x;
    const double step_y = result.y - before_y;
    converged = step_x * step_x + step_y * step_y < options.tolerance_px * options.tolerance_px;
    if (!converged) continue;

    if (!(residual <= most_here)) return result;
    const double residual_variance = (residual > 0 ? residual : 0) / (pixels - 4) / (gain * gain);
    // Covariance of (c_x, c_y): the noise of one pixel times the inverse of the normal equations. The inverse
    // accounts for the information that gain and offset take from the gradients. The regressors are twice the
    // gradients.
    Matrix2 C;
    C.col(0) = factor.solve(Vector4::Unit(0)).head<2>();
    C.col(1) = factor.solve(Vector4::Unit(1)).head<2>();
    C = W * C * W.transpose();
    const double half_sum = 2 * (C(0, 0) + C(1, 1));
    const double half_difference = 2 * (C(0, 0) - C(1, 1));
    const double cross = 4 * C(1, 0);
    const double largest = half_sum + sqrt(half_difference * half_difference + cross * cross);
    // The spline leaves a quarter of the variance of white noise, but all of its strength at low frequencies,
    // where the gradients are. Adjacent residuals are therefore correlated, and only one in four counts.
    result.sigma_px = sqrt(4 * residual_variance * largest);
    result.reach = window.reach + 2;
    result.ok = true;
  }
  return result;
}

}  // namespace plvo
