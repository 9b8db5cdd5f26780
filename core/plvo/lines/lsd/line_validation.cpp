// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/line_validation.hpp"

#include <algorithm>

#include "plvo/base/simd.hpp"
#include "plvo/lines/lsd/angle_range.hpp"
#include "plvo/math/rounding.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::lsd {
namespace {

std::int32_t squared_distance(int x, int y, PixelRun seed) {
  const std::int32_t dx = x - first_x(seed);
  const std::int32_t dy = y - seed.row;
  return dx * dx + dy * dy;
}

// Returns which pixels of the run's block are within a distance of the seed.
unsigned within(std::int32_t squared_px, PixelRun seed, PixelRun run) {
  const Int16x8 x =
      Int16x8{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<std::int16_t>(run.block * kBlockPixels - first_x(seed));
  const Int16x8 y = Int16x8{} + static_cast<std::int16_t>(run.row - seed.row);
  Int16x8 first, last;
  interleave(x, y, first, last);
  Int32x4 squared_first, squared_last;
  dot_pairs(first, first, squared_first);
  dot_pairs(last, last, squared_last);
  const Int32x4 most = Int32x4{} + squared_px;
  return ~(negative_mask(most - squared_first) | negative_mask(most - squared_last) << 4);
}

// Twice the standard deviation of the angles within a rectangle's width of the seed, limited to kTau.
Angle spread_near_seed(const LevelLineField& field, const Region& region, const Rectangle& rectangle) {
  const auto reach =
      static_cast<std::int32_t>(std::int64_t{rectangle.width_q8()} * rectangle.width_q8() / 65536);
  const Angle middle = region.angle();
  std::int32_t n = 0;
  AngleSum sum(middle);
  std::int64_t squares = 0;
  for (const PixelRun run : region.runs) {
    const unsigned near = within(reach, region.seed, run) & run.bits;
    if (near == 0) continue;
    const Angle* const angles = field.angles() + field.index(run) * kBlockPixels;
    n += kOnes[near];
    sum.add(angles, near);
    squares += squares_beyond(middle, angles, near);
  }
  const double mean = static_cast<double>(sum.beyond()) / n;
  const double variance = static_cast<double>(squares) / n - mean * mean;
  const double spread = 2 * sqrt(std::max(variance, 0.0));
  return spread >= kTau ? kTau : std::max(kLeastTolerance, static_cast<Angle>(spread));
}

// Keeps the pixels of each run that are set in keep(run), and releases the others.
template <typename Keep>
void filter(LevelLineField& field, Region& region, GradientMass& mass, Keep&& keep) {
  std::size_t kept = 0;
  AngleSum lost_angles(region.from);
  GradientMass lost_mass;
  for (const PixelRun run : region.runs) {
    const unsigned bits = keep(run) & run.bits;
    PixelRun part = run;
    part.bits = static_cast<std::uint8_t>(run.bits & ~bits);
    if (part.bits != 0) {
      lost_mass.add(field, region.seed, part);
      lost_angles.add(field.angles() + field.index(part) * kBlockPixels, part.bits);
      region.size -= kOnes[part.bits];
      release(field, part);
    }
    part.bits = static_cast<std::uint8_t>(bits);
    region.runs[kept] = part;
    kept += bits != 0 ? 1 : 0;
  }
  region.runs = region.runs.first(kept);
  region.beyond -= lost_angles.beyond();
  mass -= lost_mass;
}

// The pixels within `reach` (2^-8 px) to either side of a rectangle's axis.
class Strip {
 public:
  Strip(const Rectangle& r, std::int32_t reach)
      : dx_(r.dx),
        dy_(r.dy),
        centre_(static_cast<std::int32_t>((std::int64_t{r.y_q8} * r.dx - std::int64_t{r.x_q8} * r.dy) >> 8)),
        reach_(reach << (Rectangle::kDirectionBits - 8)) {}
  unsigned holding(PixelRun run) const {
    // Distance from the axis, 2^-14 px.
    const Int32x4 first =
        Int32x4{0, 1, 2, 3} * -dy_ + (run.row * dx_ - run.block * kBlockPixels * dy_ - centre_);
    const Int32x4 last = first + -4 * dy_;
    const Int32x4 above = Int32x4{} + reach_;
    const unsigned out = negative_mask(above - first) | negative_mask(first + reach_) |
                         (negative_mask(above - last) | negative_mask(last + reach_)) << 4;
    return ~out;
  }

 private:
  std::int32_t dx_, dy_, centre_, reach_;
};

// Largest standard deviation of the gradient's mass across a region. Beyond it, the region is not one edge
// with whiskers; it is bent or consists of several edges.
constexpr std::int32_t kMaxAcrossSd_q8 = 192;

// Noise beside an edge attaches to it as whiskers, which make the rectangle wide and empty without moving the
// edge. This function cuts them off beyond twice the standard deviation of the gradient's mass (at least a
// pixel), at most twice. Returns true if the region is dense afterwards.
bool trim(LevelLineField& field, Region& region, GradientMass& mass, Rectangle& rectangle,
          std::int32_t min_size) {
  for (int i = 0; i < 2 && !is_dense(rectangle, region.size); ++i) {
    if (rectangle.across_sd > kMaxAcrossSd_q8) return false;
    const std::int32_t reach = std::max<std::int32_t>(256, 2 * rectangle.across_sd);
    const Strip strip(rectangle, reach);
    filter(field, region, mass, [&](PixelRun run) { return strip.holding(run); });
    if (region.size < min_size) return false;
    rectangle = fit_rectangle(region, mass);
  }
  return is_dense(rectangle, region.size);
}

// Number of pixels of a row from x = first to x = last whose angle is in the range.
int count_held(const LevelLineField& field, const AngleRange& range, int y, int first, int last) {
  int held = 0;
  const int last_block = last / kBlockPixels;
  unsigned asked = 0xffU << first % kBlockPixels & 0xffU;
  for (int block = first / kBlockPixels; block <= last_block; ++block) {
    if (block == last_block) asked &= 0xffU >> (kBlockPixels - 1 - last % kBlockPixels);
    const std::ptrdiff_t at = field.index(block, y);
    held += kOnes[field.directed[static_cast<std::size_t>(at)] &
                  range.holding(field.angles() + at * kBlockPixels) & asked];
    asked = 0xffU;
  }
  return held;
}

}  // namespace

bool tighten(LevelLineField& field, Region& region, GradientMass& mass, Rectangle& rectangle,
             std::int32_t min_size, std::span<PixelRun> storage) {
  if (is_dense(rectangle, region.size)) return true;
  const PixelRun seed = region.seed;
  const Angle tolerance = spread_near_seed(field, region, rectangle);
  if (trim(field, region, mass, rectangle, min_size)) return true;
  for (const PixelRun run : region.runs) release(field, run);
  region = grow(field, seed, tolerance, storage);
  if (region.size < min_size) return false;
  mass = weigh(field, region);
  rectangle = fit_rectangle(region, mass);
  std::int32_t farthest = 0;
  for (const PixelRun run : region.runs)
    farthest = std::max({farthest, squared_distance(first_x(run), run.row, seed),
                         squared_distance(last_x(run), run.row, seed)});
  double squared_radius = farthest;
  for (int i = 0; i < 24 && !is_dense(rectangle, region.size); ++i) {
    squared_radius *= 0.75 * 0.75;
    const auto most = static_cast<std::int32_t>(squared_radius);
    filter(field, region, mass, [&](PixelRun run) { return within(most, seed, run); });
    if (region.size < min_size) return false;
    rectangle = fit_rectangle(region, mass);
  }
  return is_dense(rectangle, region.size);
}

double meaningfulness(const LevelLineField& field, const FalseAlarms& false_alarms,
                      const Rectangle& rectangle) {
  int n = 0;
  int k = 0;
  // A gradient is perpendicular to its edge and points to the brighter side.
  const AngleRange across(
      static_cast<Angle>(round_to<std::int32_t>(atan2(rectangle.dx, -rectangle.dy) * kAnglePerRadian)), kTau);
  for_each_row(field, rectangle, [&](int y, int first, int last) {
    n += last - first + 1;
    k += count_held(field, across, y, first, last);
  });
  return false_alarms.meaningfulness(n, k);
}

}  // namespace plvo::lsd
