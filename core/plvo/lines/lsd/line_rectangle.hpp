// SPDX-License-Identifier: Apache-2.0
// The rectangle that approximates a region (LSD, section 2.4). Its centre is the centre of mass of the
// gradient magnitude, its direction is the first principal axis of that mass, and its size just covers all
// pixels of the region. All further steps use fixed-point numbers, so that "inside" and "aligned" mean the
// same on every machine.
#pragma once

#include <algorithm>
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
  // Direction: a unit vector · 2^14 with the brighter side on its right. The direction towards that side is
  // (−dy, dx).
  std::int32_t dx = 1 << kDirectionBits;
  std::int32_t dy = 0;
  // Extent along the direction and across it (towards the brighter side), from the centre, 2^-8 pixels.
  std::int32_t along_min = 0;
  std::int32_t along_max = 0;
  std::int32_t across_min = 0;
  std::int32_t across_max = 0;
  // Standard deviation of the gradient's mass across the direction, 2^-8 pixels.
  std::int32_t across_sd = 0;

  std::int32_t length_q8() const { return along_max - along_min; }
  std::int32_t width_q8() const { return across_max - across_min; }  // at least 1 pixel after fit_rectangle
};

// Sums of a region's magnitudes, and of their products with x, y, x², x y and y² relative to its seed. They
// are integers, so runs can be added and removed in any order.
struct GradientMass {
  std::int64_t m = 0, mx = 0, my = 0, mxx = 0, mxy = 0, myy = 0;
  void add(const LevelLineField& field, PixelRun seed, PixelRun run);
  void operator-=(const GradientMass& part);
};
GradientMass weigh(const LevelLineField& field, const Region& region);

// region must have at least one pixel.
Rectangle fit_rectangle(const Region& region, const GradientMass& mass);

// Returns whether the region fills at least 70 % of its rectangle.
bool is_dense(const Rectangle& rectangle, std::int32_t region_size);

// Calls visit(y, first, last) for every row of the field that has pixels inside the rectangle, from x = first
// to x = last. A pixel is inside if (256 x − x_q8) dx + (256 y − y_q8) dy, rounded down to 2^-8 pixels, lies
// in along_min … along_max, and likewise across, with (−dy, dx).
template <typename Visit>
void for_each_row(const LevelLineField& field, const Rectangle& r, Visit&& visit) {
  // a · (256 x − x_q8) + b · (256 y − y_q8) is an integer, between `least` and `most` inside. The limits of a
  // row lie halfway to the next integers outside, so that rounding does not decide.
  struct Strip {
    double enters, leaves, step;  // columns + 1, and the change of both per row
    Strip(const Rectangle& r, int row, std::int32_t a, std::int32_t b, std::int32_t min, std::int32_t max) {
      // A row parallel to the strip is completely inside or outside of it; its limits are then far away.
      constexpr double kAlong = 1e-9;
      const double inverse = 1 / (256 * (a != 0 ? a : kAlong));
      const double of_row = static_cast<double>(std::int64_t{b} * (row * 256 - r.y_q8));
      constexpr double kOne = 1 << Rectangle::kDirectionBits;
      const double least = (min * kOne - 0.5 - of_row) * inverse;
      const double most = (max * kOne + kOne - 0.5 - of_row) * inverse;
      const double origin = r.x_q8 / 256.0 + 1;
      enters = origin + (least < most ? least : most);
      leaves = origin + (least < most ? most : least);
      step = -256.0 * b * inverse;
    }
    void next() {
      enters += step;
      leaves += step;
    }
  };
  // The rectangle's corners bound the rows.
  constexpr double kPixel_q22 = 256 << Rectangle::kDirectionBits;
  const double dx = r.dx / kPixel_q22, dy = r.dy / kPixel_q22;
  const double up = (dy >= 0 ? r.along_min : r.along_max) * dy + (dx >= 0 ? r.across_min : r.across_max) * dx;
  const double down =
      (dy >= 0 ? r.along_max : r.along_min) * dy + (dx >= 0 ? r.across_max : r.across_min) * dx;
  const int first_row = std::max(0, static_cast<int>(r.y_q8 / 256.0 + up - 1));
  const int last_row = std::min(field.height - 1, static_cast<int>(r.y_q8 / 256.0 + down + 1));
  Strip along(r, first_row, r.dx, r.dy, r.along_min, r.along_max);
  Strip across(r, first_row, -r.dy, r.dx, r.across_min, r.across_max);
  for (int y = first_row; y <= last_row; ++y, along.next(), across.next()) {
    const double from = std::max(std::max(along.enters, across.enters), 0.0);
    const double to = std::min(std::min(along.leaves, across.leaves), static_cast<double>(field.width));
    if (from > to) continue;
    const int first = static_cast<int>(from);
    const int last = static_cast<int>(to) - 1;
    if (first <= last) visit(y, first, last);
  }
}

}  // namespace plvo::lsd
