// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/line_rectangle.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "plvo/base/bits.hpp"
#include "plvo/base/build.hpp"
#include "plvo/base/simd.hpp"
#include "plvo/lines/lsd/angle_range.hpp"
#include "plvo/math/rounding.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::lsd {
namespace {

std::int32_t to_fixed(double value, double one) { return round_to<std::int32_t>(value * one); }

// Sums over one run, relative to its block: the pixels' magnitudes, the magnitudes times x, and times x².
struct RunMass {
  std::int32_t m, mx, mxx;
};

RunMass weigh(const std::int16_t* magnitudes, unsigned bits) {
  constexpr std::int16_t kMagnitude = (1 << LevelLineField::kReleaseBit) - 1;
  if constexpr (kSimdLoops) {
    RunMass of{};
    for (unsigned rest = bits; rest != 0; rest &= rest - 1) {
      const int x = lowest_bit(rest);
      const int w = magnitudes[x] & kMagnitude;
      of.m += w;
      of.mx += w * x;
      of.mxx += w * x * x;
    }
    return of;
  }
  Int16x8 w;
  load(magnitudes, w);
  w = w & chosen(bits) & kMagnitude;
  Int32x4 m, mx, mxx;
  dot_pairs(w, Int16x8{1, 1, 1, 1, 1, 1, 1, 1}, m);
  dot_pairs(w, Int16x8{0, 1, 2, 3, 4, 5, 6, 7}, mx);
  dot_pairs(w, Int16x8{0, 1, 4, 9, 16, 25, 36, 49}, mxx);
  Int32x4 pairs, sums;
  add_pairs(m, mx, pairs);
  add_pairs(pairs, mxx, sums);
  return {sums[0], sums[1], sums[2] + sums[3]};
}

struct Range {
  std::int32_t low, high;
};

// Packs two 16-bit numbers into one of 32 bits, and reads four of those as one vector.
std::int32_t pair_of(int x, int y) {
  return static_cast<std::int32_t>((static_cast<std::uint32_t>(x) & 0xffffU) | static_cast<std::uint32_t>(y)
                                                                                   << 16);
}
Int16x8 pairs(const Int32x4& four) {
  Int16x8 vector;
  std::memcpy(&vector, &four, sizeof vector);
  return vector;
}

// Least and greatest x · dx + y · dy, and y · dx − x · dy, in 2^-14 px. For each run, its first and its last
// pixel suffice.
void range_along_and_across(std::span<const PixelRun> runs, std::int32_t dx, std::int32_t dy, Range& along,
                            Range& across) {
  const std::int32_t axis = pair_of(dx, dy), normal = pair_of(-dy, dx);
  const Int16x8 axes = pairs(Int32x4{axis, axis, normal, normal});
  Int32x4 low = Int32x4{} + std::numeric_limits<std::int32_t>::max();
  Int32x4 high = Int32x4{} + std::numeric_limits<std::int32_t>::min();
  for (const PixelRun run : runs) {
    const std::int32_t first = pair_of(first_x(run), run.row);
    const std::int32_t last = pair_of(last_x(run), run.row);
    const Int16x8 ends = pairs(Int32x4{first, last, first, last});
    Int32x4 value;
    dot_pairs(ends, axes, value);
    take_range(value, low, high);
  }
  along = {std::min(low[0], low[1]), std::max(high[0], high[1])};
  across = {std::min(low[2], low[3]), std::max(high[2], high[3])};
}

// Range relative to the centre, 2^-8 px. It includes the centre itself.
Range about(Range range, std::int64_t centre_q22) {
  const auto offset = [&](std::int64_t q14) {
    return static_cast<std::int32_t>((q14 * 256 - centre_q22) >> Rectangle::kDirectionBits);
  };
  return {std::min<std::int32_t>(offset(range.low), 0), std::max<std::int32_t>(offset(range.high), 0)};
}

}  // namespace

void GradientMass::add(const LevelLineField& field, PixelRun seed, PixelRun run) {
  const RunMass of = weigh(field.magnitude_and_releases.data() + field.index(run) * kBlockPixels, run.bits);
  const std::int64_t x = run.block * kBlockPixels - first_x(seed);
  const std::int64_t y = run.row - seed.row;
  const std::int64_t run_mx = of.m * x + of.mx;
  m += of.m;
  mx += run_mx;
  my += of.m * y;
  mxx += (run_mx + of.mx) * x + of.mxx;
  mxy += run_mx * y;
  myy += of.m * y * y;
}

void GradientMass::operator-=(const GradientMass& part) {
  m -= part.m;
  mx -= part.mx;
  my -= part.my;
  mxx -= part.mxx;
  mxy -= part.mxy;
  myy -= part.myy;
}

GradientMass weigh(const LevelLineField& field, const Region& region) {
  GradientMass mass;
  for (const PixelRun run : region.runs) mass.add(field, region.seed, run);
  return mass;
}

Rectangle fit_rectangle(const Region& region, const GradientMass& mass) {
  // The centre relative to the seed, and the moments about it.
  const auto m = static_cast<double>(mass.m);
  const double x = static_cast<double>(mass.mx) / m;
  const double y = static_cast<double>(mass.my) / m;
  const double xx = static_cast<double>(mass.mxx) - x * static_cast<double>(mass.mx);
  const double xy = static_cast<double>(mass.mxy) - x * static_cast<double>(mass.my);
  const double yy = static_cast<double>(mass.myy) - y * static_cast<double>(mass.my);
  // The first principal axis has the angle φ with tan 2φ = 2 xy / (xx − yy). Half-angle formulas give its
  // direction without computing the angle.
  const double difference = xx - yy;
  const double h = sqrt(difference * difference + 4 * xy * xy);
  double dx = 1;
  double dy = 0;
  if (h > 0) {
    // Computes the larger of cos φ and sin φ from its square root, the other from sin 2φ = 2 sin φ cos φ.
    if (difference >= 0) {
      dx = sqrt(0.5 * (1 + difference / h));
      dy = xy / (h * dx);
    } else {
      dy = sqrt(0.5 * (1 - difference / h));
      dx = xy / (h * dy);
    }
  }
  // The brighter side, to which the gradients point, is on the right.
  const double angle = region.angle() / kAnglePerRadian;
  if (sin(angle) * dx < cos(angle) * dy) {
    dx = -dx;
    dy = -dy;
  }
  Rectangle r;
  r.x_q8 = to_fixed(first_x(region.seed) + x, 256);
  r.y_q8 = to_fixed(region.seed.row + y, 256);
  r.dx = to_fixed(dx, 1 << Rectangle::kDirectionBits);
  r.dy = to_fixed(dy, 1 << Rectangle::kDirectionBits);
  // The smaller principal moment. Rounding may make it negative.
  r.across_sd = to_fixed(sqrt(std::max(0.0, 0.5 * (xx + yy - h) / m)), 256);
  const std::int64_t x_q8 = r.x_q8;
  const std::int64_t y_q8 = r.y_q8;
  Range along, across;
  range_along_and_across(region.runs, r.dx, r.dy, along, across);
  along = about(along, x_q8 * r.dx + y_q8 * r.dy);
  across = about(across, y_q8 * r.dx - x_q8 * r.dy);
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

bool is_dense(const Rectangle& rectangle, std::int32_t region_size) {
  const std::int64_t area_q16 = std::int64_t{rectangle.length_q8()} * rectangle.width_q8();
  return static_cast<std::int64_t>(region_size) * 10 * 65536 >= area_q16 * 7;
}

}  // namespace plvo::lsd
