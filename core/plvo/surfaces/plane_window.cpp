// SPDX-License-Identifier: Apache-2.0
#include "plvo/surfaces/plane_window.hpp"

#include <array>

#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

constexpr int kReach = 3;
constexpr int kStride = 3;  // px
constexpr int kReadings = (2 * kReach + 1) * (2 * kReach + 1);
// Fewer of them than this show an edge or a hole.
constexpr int kLeastReadings = 45;
// SD of the readings from the plane, at most so many σ_d: real and rendered noise is half of one.
constexpr double kMaxRms = 1;
// Of the ray times the normal, for a ray with z = 1.
constexpr double kLeastSteepness = 0.15;

struct Reading {
  double x, y, q;  // px from the window's centre; 1/m
};

// q(x, y) = q0 + slope_x x + slope_y y, least squares.
struct InversePlane {
  double q0, slope_x, slope_y;
  double sum_xx;            // of x² about the mean, px²
  double residual_squared;  // mean
};

bool fit(const std::array<Reading, kReadings>& readings, int n, InversePlane& plane) {
  double x = 0, y = 0, q = 0;
  for (int k = 0; k < n; ++k) {
    x += readings[static_cast<std::size_t>(k)].x;
    y += readings[static_cast<std::size_t>(k)].y;
    q += readings[static_cast<std::size_t>(k)].q;
  }
  x /= n;
  y /= n;
  q /= n;
  double xx = 0, xy = 0, yy = 0, qx = 0, qy = 0, qq = 0;
  for (int k = 0; k < n; ++k) {
    const Reading& reading = readings[static_cast<std::size_t>(k)];
    const double dx = reading.x - x;
    const double dy = reading.y - y;
    const double dq = reading.q - q;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
    qx += dq * dx;
    qy += dq * dy;
    qq += dq * dq;
  }
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 0)) return false;
  plane.slope_x = (qx * yy - qy * xy) / determinant;
  plane.slope_y = (qy * xx - qx * xy) / determinant;
  plane.q0 = q - plane.slope_x * x - plane.slope_y * y;
  plane.sum_xx = xx;
  const double left = qq - plane.slope_x * qx - plane.slope_y * qy;
  plane.residual_squared = left > 0 ? left / n : 0;
  return true;
}

int read(const DepthSampler& depth, int x0, int y0, std::array<Reading, kReadings>& readings) {
  const DepthSampler::Window window(depth, x0, y0, kReach, kStride);
  std::array<std::uint16_t, 2 * kReach + 1> row;
  int n = 0;
  for (int j = -kReach; j <= kReach; ++j) {
    window.read_row(j, row);
    for (int i = -kReach; i <= kReach; ++i) {
      const double z = row[static_cast<std::size_t>(i + kReach)] * depth.metres_per_unit();
      if (z > 0) readings[static_cast<std::size_t>(n++)] = {1.0 * i * kStride, 1.0 * j * kStride, 1 / z};
    }
  }
  return n;
}

}  // namespace

bool observe_surface(const DepthSampler& depth, const Pinhole& pinhole, double u, double v,
                     double noise_scale, SurfaceSample& sample, double* depth_row) {
  Vector2 located(u, v);
  if (!depth.locate(located)) return false;
  const int x0 = static_cast<int>(located.x() + 0.5);
  const int y0 = static_cast<int>(located.y() + 0.5);
  if (!depth.inside(x0, y0)) return false;
  std::array<Reading, kReadings> readings;
  const int n = read(depth, x0, y0, readings);
  InversePlane plane;
  if (n < kLeastReadings || !fit(readings, n, plane)) return false;

  const double q = plane.q0 + plane.slope_x * (located.x() - x0) + plane.slope_y * (located.y() - y0);
  if (!(q > 0)) return false;
  const double z = 1 / q;
  const double sigma_d = depth.noise().sigma(z);
  const double sigma_q = sigma_d * q * q;
  if (!(plane.residual_squared <= kMaxRms * kMaxRms * sigma_q * sigma_q)) return false;
  const Vector3 m(plane.slope_x * pinhole.fx, plane.slope_y * pinhole.fy,
                  plane.q0 + plane.slope_x * (pinhole.cx - x0) + plane.slope_y * (pinhole.cy - y0));
  const double length = sqrt(m.squaredNorm());
  const Vector3 p = back_project(pinhole, located.x(), located.y(), z);
  const double steepness = m.dot(p) / (length * z);
  if (!(steepness > kLeastSteepness)) return false;

  sample.normal = m / -length;
  const double sigma = steepness * sigma_d;
  sample.variance = noise_scale * sigma * sigma;
  const double sigma_slope = sigma_q * pinhole.fx / length;
  sample.normal_variance = noise_scale * sigma_slope * sigma_slope / plane.sum_xx;
  sample.p = p;
  const Exposure& exposure = depth.exposure();
  if (exposure.depth_apart()) sample.p = exposure.from_depth_time(p, v, located.y());
  if (depth_row != nullptr) *depth_row = located.y();
  return true;
}

}  // namespace plvo
