// SPDX-License-Identifier: Apache-2.0
// The rectangle that stands for a region (LSD, section 2.4): centred where the gradient magnitude has its
// centre of mass, along the first principal axis of that mass, just large enough for all pixels of the
// region. From then on everything is fixed-point, so that "inside" and "aligned" mean the same on every
// machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/lines/lsd/line_support_region.hpp"

namespace plvo::lsd {

struct Rectangle {
  static constexpr int kDirectionBits = 14;

  // Centre in the field's grid, 2^-8 pixels.
  std::int32_t x_q8 = 0;
  std::int32_t y_q8 = 0;
  // Unit vector · 2^14, the brighter side on its right; that side's direction is (−dy, dx).
  std::int32_t dx = 1 << kDirectionBits;
  std::int32_t dy = 0;
  // Extent along it and across it (towards the brighter side), from the centre, 2^-8 pixels.
  std::int32_t along_min = 0;
  std::int32_t along_max = 0;
  std::int32_t across_min = 0;
  std::int32_t across_max = 0;
  // Standard deviation of the gradient's mass across it, 2^-8 pixels.
  std::int32_t across_sd = 0;

  std::int32_t along(int x, int y) const {
    const std::int64_t q22 = std::int64_t{x * 256 - x_q8} * dx + std::int64_t{y * 256 - y_q8} * dy;
    return static_cast<std::int32_t>(q22 >> kDirectionBits);
  }
  std::int32_t across(int x, int y) const {
    const std::int64_t q22 = std::int64_t{y * 256 - y_q8} * dx - std::int64_t{x * 256 - x_q8} * dy;
    return static_cast<std::int32_t>(q22 >> kDirectionBits);
  }
  std::int32_t length_q8() const { return along_max - along_min; }
  std::int32_t width_q8() const { return across_max - across_min; }  // at least 1 pixel, as fitted
};

// region: at least one pixel.
// The sums of a region's magnitudes, by themselves and times x, y, x², x y and y² from its seed: whole
// numbers, so that pieces may come and go in any order.
struct GradientMass {
  std::int64_t m = 0, mx = 0, my = 0, mxx = 0, mxy = 0, myy = 0;
  void add(const LevelLineField& field, Piece seed, Piece piece);
  void operator-=(const GradientMass& part);
};
GradientMass weigh(const LevelLineField& field, const Region& region);

Rectangle fit_rectangle(const Region& region, const GradientMass& mass);

// Does the region fill at least 70 % of its rectangle?
bool is_dense(const Rectangle& rectangle, std::int32_t region_size);

// Calls visit(y, first, last) for every row of the field that has pixels inside the rectangle: from x = first
// to x = last.
template <typename Visit>
void for_each_row(const LevelLineField& field, const Rectangle& r, Visit&& visit) {
  // The corners bound the rows; each row is bounded by the two strips, with a little to spare, then its
  // ends are tested exactly.
  const double along_min = r.along_min / 256.0 - 0.01;
  const double along_max = r.along_max / 256.0 + 0.01;
  const double across_min = r.across_min / 256.0 - 0.01;
  const double across_max = r.across_max / 256.0 + 0.01;
  const double dx = r.dx / 16384.0;
  const double dy = r.dy / 16384.0;
  const double cx = r.x_q8 / 256.0;
  const double cy = r.y_q8 / 256.0;
  const double ya = dy >= 0 ? along_min * dy : along_max * dy;
  const double yb = dy >= 0 ? along_max * dy : along_min * dy;
  const double yc = dx >= 0 ? across_min * dx : across_max * dx;
  const double yd = dx >= 0 ? across_max * dx : across_min * dx;
  const double top = cy + ya + yc - 1;
  const double bottom = cy + yb + yd + 1;
  const int first_row = top < 0 ? 0 : static_cast<int>(top);
  const int last_row = bottom > field.height - 1 ? field.height - 1 : static_cast<int>(bottom);
  const double width = field.width;
  constexpr double kFlat = 1e-3;
  const double inverse_dx = dx > kFlat || dx < -kFlat ? 1 / dx : 0;
  const double inverse_dy = dy > kFlat || dy < -kFlat ? 1 / dy : 0;
  for (int y = first_row; y <= last_row; ++y) {
    double left = 0;
    double right = width - 1;
    const auto cut = [&](double u, double v) {
      const double lower = u < v ? u : v;
      const double upper = u < v ? v : u;
      if (cx + lower > left) left = cx + lower;
      if (cx + upper < right) right = cx + upper;
    };
    const double v = y - cy;
    if (inverse_dx != 0) cut((along_min - v * dy) * inverse_dx, (along_max - v * dy) * inverse_dx);
    if (inverse_dy != 0) cut((v * dx - across_min) * inverse_dy, (v * dx - across_max) * inverse_dy);
    if (left > right) continue;
    int first = static_cast<int>(left);
    int last = static_cast<int>(right);
    const auto inside = [&](int x) {
      const std::int32_t l = r.along(x, y);
      const std::int32_t t = r.across(x, y);
      return l >= r.along_min && l <= r.along_max && t >= r.across_min && t <= r.across_max;
    };
    while (first <= last && !inside(first)) ++first;
    while (last > first && !inside(last)) --last;
    if (first <= last) visit(y, first, last);
  }
}

}  // namespace plvo::lsd
