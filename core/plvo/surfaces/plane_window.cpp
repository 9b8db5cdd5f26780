// SPDX-License-Identifier: Apache-2.0
#include "plvo/surfaces/plane_window.hpp"

#include <array>
#include <span>

#include "plvo/base/build.hpp"
#include "plvo/math/pair.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

constexpr int kPlaneReach = 3;
constexpr int kPlaneSide = 2 * kPlaneReach + 1;
constexpr int kStride = 3;  // px
constexpr int kReadings = kPlaneSide * kPlaneSide;
constexpr int kSumOfSquares =
    kPlaneReach * (kPlaneReach + 1) * kPlaneSide / 3;  // of −kPlaneReach … kPlaneReach
// With fewer readings, the window contains an edge or a hole.
constexpr int kLeastReadings = 45;
constexpr int kMostMissing = kReadings - kLeastReadings;
// Limit of the readings' standard deviation from the plane, in σ_d. Real and rendered noise is half of it.
constexpr double kMaxRms = 1;
// Limit of the ray (with z = 1) times the normal.
constexpr double kLeastSteepness = 0.15;

constexpr int kPlanePairs = (kPlaneSide + 1) / 2;  // pairs in a row; the last one holds a single reading

// Readings of a window, row by row, in the image's units; 0: no depth.
struct PlaneReadings {
  std::array<std::array<std::uint16_t, 2 * kPlanePairs>, kPlaneSide> units;
  int missing = 0;
};

// A reading from beside its place in the window, by this number of pixels.
struct DisplacedReading {
  int column, row, right, down;
};

// Replaces the missing readings of a window by others from the 3×3 pixels around their places. Gives up, with
// too many of them left missing, as soon as the window cannot have enough. Returns the number of those
// replaced.
int replace_missing(const DepthSampler& depth, const DepthSampler::Place& place, PlaneReadings& window,
                    std::array<DisplacedReading, kReadings>& displaced) {
  // The nearest pixels come first.
  constexpr std::array<std::array<int, 2>, 8> kBeside = {
      {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, 1}, {-1, 1}, {1, -1}}};
  static_assert(kStride == 3);  // the pixels around two places do not overlap
  window.missing = 0;
  int replaced = 0;
  for (int j = -kPlaneReach; j <= kPlaneReach && window.missing <= kMostMissing; ++j)
    for (int i = -kPlaneReach; i <= kPlaneReach; ++i) {
      std::uint16_t& units =
          window.units[static_cast<std::size_t>(j + kPlaneReach)][static_cast<std::size_t>(i + kPlaneReach)];
      for (std::size_t k = 0; k < kBeside.size() && units == 0; ++k) {
        const auto [right, down] = kBeside[k];
        units = depth.raw_units(place.x + kStride * i + right, place.y + kStride * j + down);
        if (units > 0) displaced[static_cast<std::size_t>(replaced++)] = {i, j, right, down};
      }
      window.missing += units == 0 ? 1 : 0;
    }
  return replaced;
}

void read_plane(const DepthSampler& depth, const DepthSampler::Place& place, PlaneReadings& window) {
  constexpr int kFar = kPlaneReach * kStride;
  const bool whole =
      depth.holds_raw(place.x - kFar, place.y - kFar) && depth.holds_raw(place.x + kFar, place.y + kFar);
  for (int j = 0; j < kPlaneSide; ++j) {
    auto& row = window.units[static_cast<std::size_t>(j)];
    row[kPlaneSide] = 0;
    for (int i = 0; i < kPlaneSide; ++i) {
      const int x = place.x + kStride * (i - kPlaneReach);
      const int y = place.y + kStride * (j - kPlaneReach);
      const std::uint16_t reading = !kSizeOptimised && whole ? *depth.raw(x, y) : depth.raw_units(x, y);
      row[static_cast<std::size_t>(i)] = reading;
      window.missing += reading == 0 ? 1 : 0;
    }
  }
}

// Sums for the plane fit. x and y are in strides from the middle. Inverse depths are relative to `from`, that
// of the first reading.
struct PlaneSums {
  double n, x, y, xx, xy, yy;
  double from, q, qx, qy, qq;
};

void leave_out_missing(const PlaneReadings& window, PlaneSums& s) {
  for (int j = -kPlaneReach; j <= kPlaneReach; ++j)
    for (int i = -kPlaneReach; i <= kPlaneReach; ++i) {
      if (window.units[static_cast<std::size_t>(j + kPlaneReach)][static_cast<std::size_t>(i + kPlaneReach)] >
          0)
        continue;
      s.n -= 1;
      s.x -= i;
      s.y -= j;
      s.xx -= i * i;
      s.xy -= i * j;
      s.yy -= j * j;
    }
}

// At least one reading must have depth.
PlaneSums add_up(const PlaneReadings& window) {
  PlaneSums s = {kReadings, 0, 0, kPlaneSide * kSumOfSquares, 0, kPlaneSide * kSumOfSquares, 0, 0, 0, 0, 0};
  if (window.missing > 0) leave_out_missing(window, s);
  for (std::size_t i = 0; s.from == 0; ++i) {
    const int reading = window.units[i / kPlaneSide][i % kPlaneSide];
    if (reading > 0) s.from = 1.0 / reading;
  }
  // Sums down the columns, two columns in parallel.
  for (int pair = 0; pair < kPlanePairs; ++pair) {
    const auto left = static_cast<std::size_t>(2 * pair);
    Pair q{}, qy{}, qq{};
    for (int j = -kPlaneReach; j <= kPlaneReach; ++j) {
      const auto& row = window.units[static_cast<std::size_t>(j + kPlaneReach)];
      const Pair reading = {static_cast<double>(row[left]), static_cast<double>(row[left + 1])};
      const Pair dq = reading > 0 ? 1 / reading - s.from : Pair{};
      q += dq;
      qy += dq * j;
      qq += dq * dq;
    }
    s.q += q[0] + q[1];
    s.qx += q[0] * (2 * pair - kPlaneReach) + q[1] * (2 * pair + 1 - kPlaneReach);
    s.qy += qy[0] + qy[1];
    s.qq += qq[0] + qq[1];
  }
  return s;
}

// Moves the displaced readings in the sums from their places in the window to where they were read.
void displace(const PlaneReadings& window, std::span<const DisplacedReading> displaced, PlaneSums& s) {
  constexpr double kStrides = 1.0 / kStride;
  for (const DisplacedReading& reading : displaced) {
    const double x = reading.column + reading.right * kStrides;
    const double y = reading.row + reading.down * kStrides;
    s.x += x - reading.column;
    s.y += y - reading.row;
    s.xx += x * x - reading.column * reading.column;
    s.xy += x * y - reading.column * reading.row;
    s.yy += y * y - reading.row * reading.row;
    const auto& row = window.units[static_cast<std::size_t>(reading.row + kPlaneReach)];
    const double dq = 1.0 / row[static_cast<std::size_t>(reading.column + kPlaneReach)] - s.from;
    s.qx += dq * (x - reading.column);
    s.qy += dq * (y - reading.row);
  }
}

// q(x, y) = q0 + slope_x x + slope_y y, by least squares.
struct InversePlane {
  double q0, slope_x, slope_y;
  double sum_xx;            // Σ x² about the mean
  double residual_squared;  // mean
};

bool fit(const PlaneSums& s, InversePlane& plane) {
  const double inverse_n = 1.0 / s.n;
  const double x = s.x * inverse_n;
  const double y = s.y * inverse_n;
  const double q = s.q * inverse_n;
  const double xx = s.xx - s.x * x;
  const double xy = s.xy - s.x * y;
  const double yy = s.yy - s.y * y;
  const double qx = s.qx - s.q * x;
  const double qy = s.qy - s.q * y;
  const double qq = s.qq - s.q * q;
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 0)) return false;
  const double scale = 1 / determinant;
  plane.slope_x = (qx * yy - qy * xy) * scale;
  plane.slope_y = (qy * xx - qx * xy) * scale;
  plane.q0 = s.from + q - plane.slope_x * x - plane.slope_y * y;
  plane.sum_xx = xx;
  const double left = qq - plane.slope_x * qx - plane.slope_y * qy;
  plane.residual_squared = left > 0 ? left * inverse_n : 0;
  return true;
}

}  // namespace

bool observe_surface(const DepthSampler& depth, const Pinhole& pinhole, double u, double v,
                     double noise_scale, SurfaceSample& sample, double expected_m, double* depth_row) {
  Vector2 located(u, v);
  if (!depth.locate(located, expected_m)) return false;
  const DepthSampler::Place place(depth, located);
  if (!place.inside) return false;
  PlaneReadings window;
  read_plane(depth, place, window);
  std::array<DisplacedReading, kReadings> displaced;
  int replaced = 0;
  if (window.missing > 0) replaced = replace_missing(depth, place, window, displaced);
  if (window.missing > kMostMissing) return false;
  PlaneSums sums = add_up(window);
  if (replaced > 0) displace(window, std::span(displaced).first(static_cast<std::size_t>(replaced)), sums);
  InversePlane plane;
  if (!fit(sums, plane)) return false;

  // Slope in 1/m per pixel of the raw image.
  const double per_m = 1 / depth.metres_per_unit();
  const Vector2 raw_slope(plane.slope_x * (per_m / kStride), plane.slope_y * (per_m / kStride));
  const double q = plane.q0 * per_m + raw_slope.dot(place.beside);
  if (!(q > 0)) return false;
  const double z = 1 / q;
  const double sigma_d = depth.noise().sigma(z);
  const double sigma_q = sigma_d * q * q;
  const double most = kMaxRms * depth.metres_per_unit() * sigma_q;
  if (!(plane.residual_squared <= most * most)) return false;
  // Slope per pixel of the undistorted image.
  const double slope_x = raw_slope.dot(place.map.step_px({1, 0}));
  const double slope_y = raw_slope.dot(place.map.step_px({0, 1}));
  const Vector3 m(slope_x * pinhole.fx, slope_y * pinhole.fy,
                  q + slope_x * (pinhole.cx - located.x()) + slope_y * (pinhole.cy - located.y()));
  const double length = sqrt(m.squaredNorm());
  const Vector3 p = back_project(pinhole, located.x(), located.y(), z);
  const double steepness = m.dot(p) / (length * z);
  if (!(steepness > kLeastSteepness)) return false;

  sample.normal = m / -length;
  const double sigma = steepness * sigma_d;
  sample.variance = noise_scale * sigma * sigma;
  const double sigma_slope = sigma_q * pinhole.fx / length;
  sample.normal_variance = noise_scale * sigma_slope * sigma_slope / (plane.sum_xx * (kStride * kStride));
  sample.p = p;
  const Exposure& exposure = depth.exposure();
  if (exposure.depth_apart()) sample.p = exposure.from_depth_time(p, v, located.y());
  if (depth_row != nullptr) *depth_row = located.y();
  return true;
}

}  // namespace plvo
