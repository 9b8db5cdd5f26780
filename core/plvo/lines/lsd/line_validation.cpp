// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/line_validation.hpp"

#include <algorithm>

#include "plvo/lines/lsd/wedge.hpp"
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

double meaningfulness(const LevelLineField& field, const FalseAlarms& false_alarms,
                      const Rectangle& rectangle) {
  int n = 0;
  int k = 0;
  // A gradient points across its edge, to the brighter side.
  const Wedge across = make_wedge(-rectangle.dy, rectangle.dx, kTau);
  for_each_row(field, rectangle, [&](int y, int first, int last) {
    n += last - first + 1;
    k += count_held(across, field.direction.data() + field.index(0, y), first, last);
  });
  return false_alarms.meaningfulness(n, k);
}

}  // namespace plvo::lsd
