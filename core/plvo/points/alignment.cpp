// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/alignment.hpp"

#include <array>
#include <cstdint>

#include "plvo/math/cholesky.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

constexpr int kRadius = kPatchRadius - 1;
// Eight columns, −4 … 3, and nine rows, −4 … 4: a row of 16-bit numbers fills a vector register of any board.
constexpr int kColumns = 2 * kRadius;
constexpr int kRows = 2 * kRadius + 1;
constexpr int kPixels = kColumns * kRows;
constexpr int kFractionBits = 5;  // of the bilinear weights: positions are read on a grid of 1/32 px

// The four regressors of the template, in integers: 2·∂T/∂x, 2·∂T/∂y, T less its mean, 1; and their normal
// equations.
struct Template {
  std::array<std::int16_t, kPixels> gx, gy, value;
  Matrix4 normal;
};

Template make_template(const Patch& patch) {
  Template t;
  // About their mean, the grey levels are nearly orthogonal to the constant: gain and offset separate well.
  std::int32_t total = 0;
  for (std::uint8_t value : patch) total += value;
  const std::int32_t mean = total / (kPatchSide * kPatchSide);
  std::array<std::int32_t, 10> sums{};
  std::size_t i = 0;
  for (int y = 1; y <= kRows; ++y) {
    const std::uint8_t* row = patch.data() + y * kPatchSide + 1;
    for (int x = 0; x < kColumns; ++x, ++i) {
      const std::int32_t gx = row[x + 1] - row[x - 1];
      const std::int32_t gy = row[x + kPatchSide] - row[x - kPatchSide];
      const std::int32_t value = row[x] - mean;
      t.gx[i] = static_cast<std::int16_t>(gx);
      t.gy[i] = static_cast<std::int16_t>(gy);
      t.value[i] = static_cast<std::int16_t>(value);
      sums[0] += gx * gx;
      sums[1] += gx * gy;
      sums[2] += gx * value;
      sums[3] += gx;
      sums[4] += gy * gy;
      sums[5] += gy * value;
      sums[6] += gy;
      sums[7] += value * value;
      sums[8] += value;
    }
  }
  sums[9] = kPixels;
  constexpr int kRow[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) t.normal(r, c) = sums[static_cast<std::size_t>(kRow[r][c])];
  return t;
}

struct Moments {
  Vector4 with_template = Vector4::Zero();  // Σ I · regressors
  double squared = 0;                       // Σ I²
};

// Blends each pixel with its right neighbour, weights g and f of 1/32, three fractional bits left.
void blend_row(const std::uint8_t* pixels, std::uint16_t f, std::uint16_t g,
               std::array<std::uint16_t, kColumns>& out) {
  for (std::size_t c = 0; c < kColumns; ++c)
    out[c] =
        static_cast<std::uint16_t>(static_cast<std::uint16_t>(pixels[c] * g + pixels[c + 1] * f + 2) >> 2);
}

// (x, y): the position of the patch's centre, in 1/32 px; the window must lie inside the image.
Moments correlate(const Template& t, GrayView image, std::int32_t x, std::int32_t y) {
  constexpr std::int32_t kOne = 1 << kFractionBits;
  const auto fx = static_cast<std::uint16_t>(x & (kOne - 1));
  const auto fy = static_cast<std::uint16_t>(y & (kOne - 1));
  const auto gx = static_cast<std::uint16_t>(kOne - fx);
  const auto gy = static_cast<std::uint16_t>(kOne - fy);
  const std::uint8_t* first =
      image.data + ((y >> kFractionBits) - kRadius) * image.stride + (x >> kFractionBits) - kRadius;
  // 16 bits throughout: after the horizontal blend three fractional bits are kept (≤ 2040), after the
  // vertical one four (≤ 4080).
  std::array<std::uint16_t, kColumns> above;
  blend_row(first, fx, gx, above);
  std::array<std::int16_t, kPixels> values;
  for (std::size_t r = 0; r < kRows; ++r) {
    std::array<std::uint16_t, kColumns> below;
    blend_row(first + static_cast<std::ptrdiff_t>(r + 1) * image.stride, fx, gx, below);
    for (std::size_t c = 0; c < kColumns; ++c)
      values[r * kColumns + c] = static_cast<std::int16_t>(
          static_cast<std::uint16_t>(static_cast<std::uint16_t>(above[c] * gy) +
                                     static_cast<std::uint16_t>(below[c] * fy) + 8) >>
          4);
    above = below;
  }
  // 72 products of at most 4080 · 510: below 2^31. Squares too, 72 · 4080².
  std::int32_t with_gx = 0;
  std::int32_t with_gy = 0;
  std::int32_t with_value = 0;
  std::int32_t sum = 0;
  std::int32_t squared = 0;
  for (std::size_t k = 0; k < kPixels; ++k) {
    with_gx += values[k] * t.gx[k];
    with_gy += values[k] * t.gy[k];
    with_value += values[k] * t.value[k];
    sum += values[k];
    squared += values[k] * values[k];
  }
  constexpr double kUnit = 1.0 / 16;
  Moments moments;
  moments.with_template << kUnit * with_gx, kUnit * with_gy, kUnit * with_value, kUnit * sum;
  moments.squared = kUnit * kUnit * static_cast<double>(squared);
  return moments;
}

}  // namespace

Alignment align_patch(const Patch& patch, GrayView image, double start_x, double start_y,
                      const AlignmentOptions& options) {
  Alignment result;
  const Template t = make_template(patch);
  Cholesky<4> factor;
  if (!factor.factor(t.normal)) return result;

  result.x = start_x;
  result.y = start_y;
  const double max_shift_squared = options.max_shift_px * options.max_shift_px;
  bool converged = false;
  while (!converged && result.iterations < options.max_iterations) {
    // Floor, then the read touches one more pixel to the right and below.
    if (!(result.x >= kRadius + 1 && result.y >= kRadius + 1 && result.x < image.width - kRadius - 2 &&
          result.y < image.height - kRadius - 2))
      return result;
    constexpr double kOne = 1 << kFractionBits;
    const auto x = static_cast<std::int32_t>(result.x * kOne + 0.5);
    const auto y = static_cast<std::int32_t>(result.y * kOne + 0.5);
    const Moments moments = correlate(t, image, x, y);
    const Vector4 solution = factor.solve(moments.with_template);
    ++result.iterations;
    const double gain = solution[2];
    if (!(gain > 0.2 && gain < 5)) return result;
    // The regressors are twice the gradients.
    const double before_x = result.x;
    const double before_y = result.y;
    result.x = x / kOne - 2 * solution[0] / gain;
    result.y = y / kOne - 2 * solution[1] / gain;
    const double dx = result.x - start_x;
    const double dy = result.y - start_y;
    if (!(dx * dx + dy * dy <= max_shift_squared)) return result;
    // Not the regression's own step: that one starts on the grid of 1/32 px, not where the last one ended.
    const double step_x = result.x - before_x;
    const double step_y = result.y - before_y;
    converged = step_x * step_x + step_y * step_y < options.tolerance_px * options.tolerance_px;
    if (!converged) continue;

    const double residual = moments.squared - solution.dot(moments.with_template);
    const double mean = t.normal(2, 3) / kPixels;
    const double variance = t.normal(2, 2) / kPixels - mean * mean;
    const double residual_variance = (residual > 0 ? residual : 0) / (kPixels - 4) / (gain * gain);
    if (!(residual_variance <= options.max_residual * options.max_residual * variance)) return result;
    // Covariance of (c_x, c_y): the noise of one pixel through the inverse of the normal equations, so that
    // what gain and offset take of the gradients' information is not counted. Regressors are twice the
    // gradients.
    const Vector4 column_x = factor.solve(Vector4::Unit(0));
    const Vector4 column_y = factor.solve(Vector4::Unit(1));
    const double half_sum = 2 * (column_x[0] + column_y[1]);
    const double half_difference = 2 * (column_x[0] - column_y[1]);
    const double cross = 4 * column_x[1];
    const double largest = half_sum + sqrt(half_difference * half_difference + cross * cross);
    result.sigma_px = sqrt(residual_variance * largest);
    result.ok = true;
  }
  return result;
}

}  // namespace plvo
