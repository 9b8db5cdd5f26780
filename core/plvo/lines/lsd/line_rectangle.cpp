// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/line_rectangle.hpp"

#include <algorithm>
#include <cstring>

#include "plvo/base/lanes.hpp"
#include "plvo/math/rounding.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::lsd {
namespace {

std::int32_t to_fixed(double value, double one) { return round_to<std::int32_t>(value * one); }

struct Moments {
  double mass = 0;
  double x = 0, y = 0;            // centre, from the seed
  double xx = 0, xy = 0, yy = 0;  // about the centre
};

Moments weigh(const LevelLineField& field, std::span<const Pixel> pixels) {
  // Integers about the seed: exact, so the order of the pixels does not matter.
  const Pixel seed = pixels.front();
  const std::uint16_t* const magnitudes = field.magnitude.data();
  std::int64_t m = 0, mx = 0, my = 0, mxx = 0, mxy = 0, myy = 0;
  for (const Pixel& pixel : pixels) {
    const std::int64_t w = magnitudes[field.index(pixel.x, pixel.y)];
    const std::int64_t x = pixel.x - seed.x;
    const std::int64_t y = pixel.y - seed.y;
    m += w;
    mx += w * x;
    my += w * y;
    mxx += w * x * x;
    mxy += w * x * y;
    myy += w * y * y;
  }
  Moments moments;
  moments.mass = static_cast<double>(m);
  moments.x = static_cast<double>(mx) / moments.mass;
  moments.y = static_cast<double>(my) / moments.mass;
  moments.xx = static_cast<double>(mxx) - moments.x * static_cast<double>(mx);
  moments.xy = static_cast<double>(mxy) - moments.x * static_cast<double>(my);
  moments.yy = static_cast<double>(myy) - moments.y * static_cast<double>(my);
  return moments;
}

struct Range {
  std::int32_t low, high;
  void take(std::int32_t value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// Least and greatest x · dx + y · dy, in 2^-14 px: four pixels at once.
Range range_along(std::span<const Pixel> pixels, std::int32_t dx, std::int32_t dy) {
  static_assert(sizeof(Pixel) == 2 * sizeof(std::int16_t));
  const auto along = [&](Pixel p) { return p.x * dx + p.y * dy; };
  const std::int32_t first = along(pixels.front());
  Range range{first, first};
  const Lanes direction = Lanes{1, 0, 1, 0, 1, 0, 1, 0} * static_cast<std::int16_t>(dx) +
                          Lanes{0, 1, 0, 1, 0, 1, 0, 1} * static_cast<std::int16_t>(dy);
  WideLanes low = WideLanes{} + first;
  WideLanes high = low;
  std::size_t i = 0;
  for (; i + 4 <= pixels.size(); i += 4) {
    Lanes four;
    std::memcpy(&four, &pixels[i], sizeof four);
    WideLanes value;
    dot_pairs(four, direction, value);
    take_range(value, low, high);
  }
  for (; i < pixels.size(); ++i) range.take(along(pixels[i]));
  for (int lane = 0; lane < 4; ++lane) {
    range.take(low[lane]);
    range.take(high[lane]);
  }
  return range;
}

// From the centre, 2^-8 px, and the centre itself.
Range about(Range range, std::int64_t centre_q22) {
  const auto offset = [&](std::int64_t q14) {
    return static_cast<std::int32_t>((q14 * 256 - centre_q22) >> kDirectionBits);
  };
  return {std::min<std::int32_t>(offset(range.low), 0), std::max<std::int32_t>(offset(range.high), 0)};
}

}  // namespace

Rectangle fit_rectangle(const LevelLineField& field, const Region& region) {
  const Moments moments = weigh(field, region.pixels);
  // The first principal axis is at angle φ with tan 2φ = 2 xy / (xx − yy); half-angle formulas give it
  // without one.
  const double difference = moments.xx - moments.yy;
  const double h = sqrt(difference * difference + 4 * moments.xy * moments.xy);
  double dx = 1;
  double dy = 0;
  if (h > 0) {
    // Of cos φ and sin φ take the larger from its square root, the other from sin 2φ = 2 sin φ cos φ.
    if (difference >= 0) {
      dx = sqrt(0.5 * (1 + difference / h));
      dy = moments.xy / (h * dx);
    } else {
      dy = sqrt(0.5 * (1 - difference / h));
      dx = moments.xy / (h * dy);
    }
  }
  // The brighter side, where the gradients point, is on the right: (−dy, dx) · sum ≥ 0.
  if (static_cast<double>(region.sum_y) * dx < static_cast<double>(region.sum_x) * dy) {
    dx = -dx;
    dy = -dy;
  }
  Rectangle r;
  const Pixel seed = region.pixels.front();
  r.x_q8 = to_fixed(seed.x + moments.x, 256);
  r.y_q8 = to_fixed(seed.y + moments.y, 256);
  r.dx = to_fixed(dx, 1 << kDirectionBits);
  r.dy = to_fixed(dy, 1 << kDirectionBits);
  // The smaller principal moment; rounding may take it below 0.
  r.across_sd = to_fixed(sqrt(std::max(0.0, 0.5 * (moments.xx + moments.yy - h) / moments.mass)), 256);
  const std::int64_t x_q8 = r.x_q8;
  const std::int64_t y_q8 = r.y_q8;
  const Range along = about(range_along(region.pixels, r.dx, r.dy), x_q8 * r.dx + y_q8 * r.dy);
  const Range across = about(range_along(region.pixels, -r.dy, r.dx), y_q8 * r.dx - x_q8 * r.dy);
  r.along_min = along.low;
  r.along_max = along.high;
  r.across_min = across.low;
  r.across_max = across.high;
  if (r.width_q8() < 256) {
    const std::int32_t missing = 256 - r.width_q8();
    r.across_min -= missing / 2;
    r.across_max += missing - missing / 2;
  }
  return r;
}

bool is_dense(const Rectangle& rectangle, std::size_t region_size) {
  const std::int64_t area_q16 = std::int64_t{rectangle.length_q8()} * rectangle.width_q8();
  return static_cast<std::int64_t>(region_size) * 10 * 65536 >= area_q16 * 7;
}

}  // namespace plvo::lsd
