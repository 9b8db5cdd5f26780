// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/depth_sampler.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <span>

#include "plvo/base/build.hpp"
#include "plvo/base/simd.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

// A depth jump is a difference that neither noise nor a steep surface explains: 6 σ, and 4 % of the depth.
double jump_behind(double depth_m, const DepthNoise& noise) {
  return std::max(6 * noise.sigma(depth_m), 0.04 * depth_m);
}

// Sums over the depths of a window, in the image's units, that belong to one surface: those from `least` to
// `most`. The sums are integers, so they do not depend on the order. x and y are in px from the window's
// centre.
struct SurfaceSums {
  std::int32_t least = 0, most = 0;
  std::int32_t n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  // Sums with d = depth − least.
  std::int64_t d = 0, dx = 0, dy = 0, dd = 0;
};

// The largest depth that may belong to the surface whose nearest depth is given.
std::int32_t farthest(std::int32_t nearest, double metres_per_unit, const DepthNoise& noise) {
  const double nearest_m = nearest * metres_per_unit;
  const double end = (nearest_m + jump_behind(nearest_m, noise)) / metres_per_unit;
  return end < 65535 ? static_cast<std::int32_t>(end) : 65535;
}

// The depth readings of a window, row by row; 0: no depth.
struct WindowReadings {
  std::array<std::uint16_t, (2 * DepthSampler::kMaxRadius + 1) * (2 * DepthSampler::kMaxRadius + 1)> units;
  int radius = 0;
  std::size_t count = 0;  // readings with depth
  std::size_t side() const { return static_cast<std::size_t>(2 * radius + 1); }
  std::span<const std::uint16_t> all() const { return {units.data(), side() * side()}; }
};

// x, y: the window's centre in the raw image.
void read_window(const DepthSampler& depth, int x, int y, int radius, WindowReadings& readings) {
  readings.radius = radius;
  readings.count = 0;
  std::size_t i = 0;
  for (int row = y - radius; row <= y + radius; ++row)
    for (int column = x - radius; column <= x + radius; ++column) {
      readings.units[i] = depth.raw_units(column, row);
      readings.count += readings.units[i++] > 0 ? 1 : 0;
    }
}

// Finds the nearest depth, supported by at least three readings, and the end of its surface. One or two
// readings may be flying pixels in front of the surface. Returns false if there is no such depth.
bool nearest_surface(const WindowReadings& readings, double metres_per_unit, const DepthNoise& noise,
                     SurfaceSums& surface) {
  const std::size_t least = readings.count < 3 ? readings.count : 3;
  for (int tries = 0; tries < 3; ++tries) {
    std::int32_t next = 65536;
    for (const std::uint16_t reading : readings.all())
      if (reading > surface.least && reading < next) next = reading;
    if (next == 65536) return false;
    surface.least = next;
    surface.most = farthest(next, metres_per_unit, noise);
    std::size_t support = 0;
    for (const std::uint16_t reading : readings.all())
      support += reading >= surface.least && reading <= surface.most ? 1 : 0;
    if (support >= least) return true;
  }
  return false;
}

void sum_up(const WindowReadings& readings, SurfaceSums& sums) {
  std::size_t i = 0;
  for (int y = -readings.radius; y <= readings.radius; ++y)
    for (int x = -readings.radius; x <= readings.radius; ++x) {
      const std::int32_t reading = readings.units[i++];
      if (reading < sums.least || reading > sums.most) continue;
      const std::int64_t d = reading - sums.least;
      sums.n += 1;
      sums.x += x;
      sums.y += y;
      sums.xx += x * x;
      sums.xy += x * y;
      sums.yy += y * y;
      sums.d += d;
      sums.dx += d * x;
      sums.dy += d * y;
      sums.dd += d * d;
    }
}

// Returns whether each quarter of the window around (x, y) has a reading: without, no surface surrounds it.
// Most pixels without depth lie beside or within a large area without depth, so this saves most of the work.
bool may_be_surrounded(const DepthSampler& depth, int x, int y) {
  constexpr int kReach = DepthSampler::kMaxRadius;
  const auto has_reading = [&](int left, int top, int columns, int rows) {
    for (int row = top; row < top + rows; ++row)
      for (int column = left; column < left + columns; ++column)
        if (depth.raw_units(column, row) > 0) return true;
    return false;
  };
  return has_reading(x + 1, y, kReach, kReach + 1) && has_reading(x - kReach, y + 1, kReach + 1, kReach) &&
         has_reading(x - kReach, y - kReach, kReach, kReach + 1) &&
         has_reading(x, y - kReach, kReach + 1, kReach);
}

// Returns whether readings of the surface surround the window's centre. The window without its centre
// consists of four quarters, each from one half-axis to before the next; each of them must have a reading.
bool surrounds_centre(const SurfaceSums& surface, const WindowReadings& readings) {
  unsigned quarters = 0;
  std::size_t i = 0;
  for (int y = -readings.radius; y <= readings.radius; ++y)
    for (int x = -readings.radius; x <= readings.radius; ++x) {
      const std::int32_t reading = readings.units[i++];
      if (reading < surface.least || reading > surface.most || (x == 0 && y == 0)) continue;
      quarters |= x > 0 && y >= 0 ? 1U : x <= 0 && y > 0 ? 2U : x < 0 && y <= 0 ? 4U : 8U;
    }
  return quarters == 15;
}

#ifndef PLVO_SIMD_LOOPS

// Does the same as nearest_surface and sum_up if the whole window belongs to one surface, which is the usual
// case; otherwise returns false. corner: top-left pixel of the window; eight columns and 2 · radius + 1 rows
// must be readable from there.
bool sum_up_whole(const std::uint16_t* corner, std::ptrdiff_t stride, int radius, double metres_per_unit,
                  const DepthNoise& noise, SurfaceSums& sums) {
  constexpr std::size_t kMostRows = 2 * DepthSampler::kMaxRadius + 1;
  constexpr Int16x8 kEightColumns = {0, 1, 2, 3, 4, 5, 6, 7};
  constexpr std::int16_t kSign =
      std::numeric_limits<std::int16_t>::min();  // flips the sign bit: unsigned order becomes signed order
  const auto side = static_cast<std::int16_t>(2 * radius + 1);
  const Int16x8 of_window = kEightColumns < side;
  std::array<Int16x8, kMostRows> rows;
  Int16x8 low = (Int16x8{} + std::numeric_limits<std::int16_t>::max());
  Int16x8 high = (Int16x8{} + kSign);
  for (std::size_t j = 0; j < static_cast<std::size_t>(side); ++j, corner += stride) {
    Int16x8 row;
    std::memcpy(&row, corner, sizeof row);
    row ^= kSign;
    rows[j] = row;
    low = row < low ? row : low;
    high = row > high ? row : high;
  }
  std::int32_t least = low[0];
  std::int32_t most = high[0];
  for (int i = 1; i < side; ++i) {
    least = std::min<std::int32_t>(least, low[i]);
    most = std::max<std::int32_t>(most, high[i]);
  }
  constexpr std::int32_t kLargestRange = 1 << 12;  // 49 times its square has less than 31 bits
  sums.least = least - kSign;
  if (sums.least == 0 || most - least > kLargestRange) return false;
  sums.most = farthest(sums.least, metres_per_unit, noise);
  if (most - kSign > sums.most) return false;

  const Int16x8 across = (kEightColumns - static_cast<std::int16_t>(radius)) & of_window;
  const Int16x8 one = of_window & 1;
  Int32x4 d{}, dx{}, dy{}, dd{}, part;
  for (int j = 0; j < side; ++j) {
    const Int16x8 row = (rows[static_cast<std::size_t>(j)] - static_cast<std::int16_t>(least)) & of_window;
    dot_pairs(row, one, part);
    d += part;
    dy += part * (j - radius);
    dot_pairs(row, across, part);
    dx += part;
    dot_pairs(row, row, part);
    dd += part;
  }
  const auto total = [](const Int32x4& w) { return std::int64_t{w[0]} + w[1] + w[2] + w[3]; };
  sums.n = side * side;
  sums.x = sums.y = sums.xy = 0;
  sums.xx = sums.yy = side * (side * side - 1) / 12 * side;
  sums.d = total(d);
  sums.dx = total(dx);
  sums.dy = total(dy);
  sums.dd = total(dd);
  return true;
}

#endif

// Returns the depth at (x, y) px from the window's centre, in the image's units; slope receives its change
// per pixel. Fits a least-squares plane in inverse depth, because a plane in the world is a plane over the
// image in inverse depth, and there the Kinect's noise is uniform. The fit uses the deviation from the mean
// c: 1/z = (1 − e + e²) / c with e = z/c − 1. The neglected terms are a hundredth of the noise. If the
// readings lie (nearly) on one line, the result is their mean.
double plane_depth(const SurfaceSums& s, double x, double y, double& slope) {
  const double inverse_n = 1.0 / s.n;
  const double mean_d = static_cast<double>(s.d) * inverse_n;
  const double mean = s.least + mean_d;
  const double mean_x = s.x * inverse_n;
  const double mean_y = s.y * inverse_n;
  const double cxx = s.xx - s.x * mean_x;
  const double cxy = s.xy - s.x * mean_y;
  const double cyy = s.yy - s.y * mean_y;
  const double determinant = cxx * cyy - cxy * cxy;
  slope = 0;
  if (!(determinant > 0.1 * s.n * s.n)) return mean;
  const double cdx = static_cast<double>(s.dx) - mean_d * s.x;
  const double cdy = static_cast<double>(s.dy) - mean_d * s.y;
  const double scale = 1 / (determinant * mean);
  const double slope_x = (cdx * cyy - cdy * cxy) * scale;  // derivative of e
  const double slope_y = (cdy * cxx - cdx * cxy) * scale;
  const double squares = static_cast<double>(s.dd) * inverse_n - mean_d * mean_d;
  const double inverse = 1 + squares / (mean * mean) - slope_x * (x - mean_x) - slope_y * (y - mean_y);
  if (!(inverse > 0)) return mean;
  // The plane only interpolates: its depth is clamped to the range of the fitted depths.
  const double depth = std::clamp<double>(mean / inverse, s.least, s.most);
  slope = depth * depth / mean * sqrt(slope_x * slope_x + slope_y * slope_y);
  return depth;
}

// beside: position in px from the window's centre.
DepthSample sample_surface(const SurfaceSums& surface, const Vector2& beside, bool on_edge,
                           double metres_per_unit, const DepthNoise& noise) {
  DepthSample result;
  double slope = 0;
  result.on_edge = on_edge;
  result.depth_m = plane_depth(surface, beside.x(), beside.y(), slope) * metres_per_unit;
  const double sigma_d = noise.sigma(result.depth_m);
  const double sigma_registration = slope * metres_per_unit * noise.registration_px;
  result.sigma_m = sqrt(sigma_d * sigma_d + sigma_registration * sigma_registration);
  // In a mixed window, the depth of the nearer surface is less certain.
  if (on_edge) result.sigma_m *= 2;
  return result;
}

}  // namespace

DepthSampler::Place::Place(const DepthSampler& sampler, const Vector2& located)
    : Place(sampler, located, static_cast<int>(located.x() + 0.5), static_cast<int>(located.y() + 0.5)) {}

DepthSampler::Place::Place(const DepthSampler& sampler, const Vector2& located, int ideal_x, int ideal_y)
    : map(sampler.map_, std::clamp(ideal_x, 0, sampler.depth_.width - 1),
          std::clamp(ideal_y, 0, sampler.depth_.height - 1)) {
  if (!sampler.inside(ideal_x, ideal_y)) return;
  const Vector2 raw = map.position_px(located - Vector2(ideal_x, ideal_y));
  inside = raw.x() > -0.5 && raw.y() > -0.5 && raw.x() < sampler.depth_.width - 0.5 &&
           raw.y() < sampler.depth_.height - 0.5;
  if (!inside) return;
  x = static_cast<int>(raw.x() + 0.5);
  y = static_cast<int>(raw.y() + 0.5);
  beside = raw - Vector2(x, y);
}

void DepthSampler::fetch() const {
  if constexpr (kSizeOptimised) return;  // the caches of small processors cannot hold the image
  constexpr int kCacheLine = 64 / sizeof(std::uint16_t);
  for (int y = 0; y < depth_.height; ++y) {
    const volatile std::uint16_t* const row = depth_.data + y * depth_.stride;
    for (int x = 0; x < depth_.width; x += kCacheLine) (void)row[x];
  }
}

double DepthSampler::near(int x, int y) const {
  int raw_x = 0;
  int raw_y = 0;
  if (!inside(x, y) || !map_.raw_pixel(x, y, raw_x, raw_y)) return 0;
  const std::uint16_t reading = *raw(raw_x, raw_y);
  if (reading > 0) return reading * depth_.metres_per_unit;
  return sample_between(raw_x, raw_y).depth_m;
}

bool DepthSampler::follow(const Vector2& pixel, int guesses, Vector2& located, double& depth_m) const {
  // Fixed-point iteration: the position depends on the depth, and the depth is read at the position. Most of
  // the displacement comes from the rotation and is the same for every depth.
  const Pinhole& pinhole = exposure_.pinhole();
  const Vector3 ray = back_project(pinhole, pixel.x(), pixel.y(), 1);
  for (int i = 0; i < guesses; ++i) {
    const double read = near(static_cast<int>(located.x() + 0.5), static_cast<int>(located.y() + 0.5));
    if (read > 0) depth_m = read;
    const Vector3 p = exposure_.at_depth_time(depth_m * ray, pixel.y(), located.y());
    if (!(p.z() > kNearestSeen_m)) return false;
    const double inverse = 1 / p.z();
    located = {pinhole.fx * p.x() * inverse + pinhole.cx, pinhole.fy * p.y() * inverse + pinhole.cy};
    constexpr double kFar = UndistortionMap::kMaxSide;
    const Vector2 moved = located - pixel;
    if (!(moved.x() > -kFar && moved.x() < kFar && moved.y() > -kFar && moved.y() < kFar)) return false;
  }
  return true;
}

bool DepthSampler::locate(Vector2& pixel, double expected_m) const {
  if (!exposure_.depth_apart()) return true;
  Vector2 located = pixel;
  if (expected_m > 0) {
    const Pinhole& pinhole = exposure_.pinhole();
    const Vector3 p =
        exposure_.as_depth_sees(back_project(pinhole, pixel.x(), pixel.y(), expected_m), pixel.y());
    if (!(p.z() > kNearestSeen_m)) return false;
    located = project(pinhole, p);
  } else {
    double depth_m = kAssumedDepth_m;
    if (!follow(pixel, kGuesses, located, depth_m)) return false;
  }
  pixel = located;
  return located.x() >= 0 && located.y() >= 0 && located.x() < depth_.width && located.y() < depth_.height;
}

DepthSample DepthSampler::sample(double u, double v, int radius, double expected_m) const {
  Vector2 located(u, v);
  if (!locate(located, expected_m)) return {};
  DepthSample result = sample_window(located, radius);
  if (result.depth_m > 0) result.depth_m = at_colour_time(v, located, result.depth_m);
  if (!(result.depth_m > 0)) return {};
  result.located = located;
  return result;
}

DepthSample DepthSampler::sample_window(const Vector2& located, int radius) const {
  const Place place(*this, located);
  if (!place.inside) return {};
  radius = std::min(radius, kMaxRadius);
  SurfaceSums sums;
#ifndef PLVO_SIMD_LOOPS
  const int left = place.x - radius;
  const int top = place.y - radius;
  if (holds_raw(left, top) && holds_raw(left + 7, place.y + radius) &&
      sum_up_whole(raw(left, top), depth_.stride, radius, depth_.metres_per_unit, noise_, sums))
    return sample_surface(sums, place.beside, false, depth_.metres_per_unit, noise_);
#endif
  WindowReadings readings;
  read_window(*this, place.x, place.y, radius, readings);
  if (2 * readings.count < readings.all().size())
    return radius > 0 ? sample_between(place.x, place.y, place.beside) : DepthSample{};
  sums = {};
  if (!nearest_surface(readings, depth_.metres_per_unit, noise_, sums)) return {};
  sum_up(readings, sums);
  const bool on_edge = static_cast<std::size_t>(sums.n) < readings.count;
  return sample_surface(sums, place.beside, on_edge, depth_.metres_per_unit, noise_);
}

DepthSample DepthSampler::sample_between(int x, int y, const Vector2& beside) const {
  if (!may_be_surrounded(*this, x, y)) return {};
  WindowReadings readings;
  read_window(*this, x, y, kMaxRadius, readings);
  SurfaceSums sums;
  if (!nearest_surface(readings, depth_.metres_per_unit, noise_, sums)) return {};
  if (!surrounds_centre(sums, readings)) return {};
  sum_up(readings, sums);
  const bool on_edge = static_cast<std::size_t>(sums.n) < readings.count;
  return sample_surface(sums, beside, on_edge, depth_.metres_per_unit, noise_);
}

}  // namespace plvo
