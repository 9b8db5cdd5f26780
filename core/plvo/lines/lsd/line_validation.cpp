// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/line_validation.hpp"

#include <algorithm>

#include "plvo/math/trigonometry.hpp"

namespace plvo::lsd {
namespace {

std::int32_t squared_distance(Pixel a, Pixel b) {
  const std::int32_t dx = a.x - b.x;
  const std::int32_t dy = a.y - b.y;
  return dx * dx + dy * dy;
}

// Twice the standard deviation of the directions within a rectangle's width of the seed, taken over sines of
// the angle to the seed's direction (they are small), and never above kTau.
Tolerance spread_near_seed(const LevelLineField& field, const Region& region, const Rectangle& rectangle) {
  const Pixel seed = region.pixels.front();
  const Direction d = field.direction[field.index(seed.x, seed.y)];
  const std::int64_t reach = std::int64_t{rectangle.width_q8()} * rectangle.width_q8();
  std::int64_t n = 0;
  std::int64_t sum = 0;
  std::int64_t squares = 0;
  for (const Pixel& pixel : region.pixels) {
    if (std::int64_t{squared_distance(seed, pixel)} * 65536 > reach) continue;
    const Direction e = field.direction[field.index(pixel.x, pixel.y)];
    const std::int64_t sine = (d.x * e.y - d.y * e.x) / 16384;  // · 2^14
    ++n;
    sum += sine;
    squares += sine * sine;
  }
  const auto count = static_cast<double>(n);
  const double mean = static_cast<double>(sum) / count;
  const double variance = static_cast<double>(squares) / count - mean * mean;
  const double sine = 2 * sqrt(std::max(variance, 0.0)) / 16384.0;
  if (sine >= 0.38) return kTau;  // sin 22.5° = 0.383
  return {std::max(kLeastTolerance.tangent_q15,
                   static_cast<std::int32_t>(sine / sqrt(1 - sine * sine) * 32768.0))};
}

// Keeps the pixels for which keep(pixel) holds, in their order; releases the rest.
template <typename Keep>
void filter(LevelLineField& field, Region& region, Keep&& keep) {
  std::size_t kept = 0;
  region.sum_x = region.sum_y = 0;
  for (const Pixel pixel : region.pixels) {
    if (!keep(pixel)) {
      release(field, {&pixel, 1});
      continue;
    }
    const Direction d = field.direction[field.index(pixel.x, pixel.y)];
    region.sum_x += d.x;
    region.sum_y += d.y;
    region.pixels[kept++] = pixel;
  }
  region.pixels = region.pixels.first(kept);
}

// A region whose gradient spreads further across than this is not one edge with whiskers but bent, or several
// edges.
constexpr std::int32_t kMaxAcrossSd_q8 = 192;

// Noise beside an edge grows onto it as whiskers, which make the rectangle wide and empty without moving the
// edge. Cuts them off, beyond twice the standard deviation of the gradient's mass (at least a pixel), at most
// twice; true if that makes the region dense.
bool trim(LevelLineField& field, Region& region, Rectangle& rectangle, std::size_t min_size) {
  for (int i = 0; i < 2 && !is_dense(rectangle, region.pixels.size()); ++i) {
    if (rectangle.across_sd > kMaxAcrossSd_q8) return false;
    const std::int32_t reach = std::max<std::int32_t>(256, 2 * rectangle.across_sd);
    filter(field, region, [&](Pixel pixel) {
      const std::int32_t t = rectangle.across(pixel.x, pixel.y);
      return t >= -reach && t <= reach;
    });
    if (region.pixels.size() < min_size) return false;
    rectangle = fit_rectangle(field, region);
  }
  return is_dense(rectangle, region.pixels.size());
}

// A pixel of the rectangle as validate keeps it: its offset across in the high bits, its level + 1 in the low
// four.
constexpr int kLevelBits = 4;

struct Variant {
  std::int32_t across_min = 0;
  std::int32_t across_max = 0;
  int level = 0;
};

struct Best {
  Variant variant;
  double meaningfulness = 0;
};

// Counts the variant's pixels; keeps it if it beats the best.
void consider(std::span<const std::int32_t> samples, const FalseAlarms& false_alarms, const Variant& variant,
              Best& best) {
  int n = 0;
  int k = 0;
  for (const std::int32_t sample : samples) {
    const std::int32_t across = sample >> kLevelBits;
    const bool inside = across >= variant.across_min && across <= variant.across_max;
    const bool aligned = (sample & ((1 << kLevelBits) - 1)) > variant.level;
    n += inside ? 1 : 0;
    k += inside && aligned ? 1 : 0;
  }
  const double meaningfulness = false_alarms.meaningfulness(n, k, variant.level);
  if (meaningfulness > best.meaningfulness) best = {variant, meaningfulness};
}

}  // namespace

bool tighten(LevelLineField& field, Region& region, Rectangle& rectangle, std::size_t min_size,
             std::span<Pixel> storage) {
  if (is_dense(rectangle, region.pixels.size())) return true;
  const Pixel seed = region.pixels.front();
  const Tolerance tolerance = spread_near_seed(field, region, rectangle);
  if (trim(field, region, rectangle, min_size)) return true;
  release(field, region.pixels);
  region = grow(field, seed, tolerance, storage);
  if (region.pixels.size() < min_size) return false;
  rectangle = fit_rectangle(field, region);
  std::int32_t farthest = 0;
  for (const Pixel& pixel : region.pixels) farthest = std::max(farthest, squared_distance(seed, pixel));
  double squared_radius = farthest;
  for (int i = 0; i < 24 && !is_dense(rectangle, region.pixels.size()); ++i) {
    squared_radius *= 0.75 * 0.75;
    const auto most = static_cast<std::int32_t>(squared_radius);
    filter(field, region, [&](Pixel pixel) { return squared_distance(seed, pixel) <= most; });
    if (region.pixels.size() < min_size) return false;
    rectangle = fit_rectangle(field, region);
  }
  return is_dense(rectangle, region.pixels.size());
}

double validate(const LevelLineField& field, const FalseAlarms& false_alarms, Rectangle& rectangle,
                std::span<std::int32_t> samples) {
  std::size_t count = 0;
  int aligned = 0;
  for_each_pixel(field, rectangle, [&](int x, int y, std::int32_t across) {
    const int level = alignment_level(rectangle, field.direction[field.index(x, y)]);
    aligned += level >= 0 ? 1 : 0;
    samples[count++] = across * (1 << kLevelBits) + level + 1;
  });
  const std::span<const std::int32_t> inside = samples.first(count);
  const Variant whole{rectangle.across_min, rectangle.across_max, 0};
  Best best{whole, false_alarms.meaningfulness(static_cast<int>(count), aligned, 0)};
  constexpr std::int32_t kHalfPixel = 128;
  constexpr std::int32_t kQuarterPixel = 64;
  constexpr int kTries = 5;
  // Each step starts from the best so far; the first step that finds a meaningful variant is the last.
  for (int step = 0; step < 5 && best.meaningfulness < 0; ++step) {
    Variant variant = best.variant;
    for (int i = 0; i < kTries; ++i) {
      if (step == 0 || step == 4) {
        if (++variant.level >= kPrecisionLevels) break;
      } else {
        if (variant.across_max - variant.across_min <= 2 * kHalfPixel) break;
        if (step == 1) {
          variant.across_min += kQuarterPixel;
          variant.across_max -= kQuarterPixel;
        } else if (step == 2) {
          variant.across_max -= kHalfPixel;
        } else {
          variant.across_min += kHalfPixel;
        }
      }
      consider(inside, false_alarms, variant, best);
    }
  }
  rectangle.across_min = best.variant.across_min;
  rectangle.across_max = best.variant.across_max;
  return best.meaningfulness;
}

}  // namespace plvo::lsd
