// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/depth_sampler.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "plvo/base/build.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

constexpr int kMaxWindow = (2 * DepthSampler::kMaxRadius + 1) * (2 * DepthSampler::kMaxRadius + 1);

// Least-squares plane through inverse depths: q(x, y) = q0 + qx x + qy y. In inverse depth a plane of the
// world is a plane over the image exactly, and the Kinect's own noise is even.
class InverseDepthPlane {
 public:
  void add(double x, double y, double q) {
    n_ += 1;
    x_ += x;
    y_ += y;
    xx_ += x * x;
    xy_ += x * y;
    yy_ += y * y;
    q_ += q;
    qx_ += q * x;
    qy_ += q * y;
  }
  // False when the pixels lie (nearly) on one line. The values are those at x = y = 0.
  bool solve(double& q0, double& slope_x, double& slope_y) const {
    const double mean_x = x_ / n_;
    const double mean_y = y_ / n_;
    const double cxx = xx_ - x_ * mean_x;
    const double cxy = xy_ - x_ * mean_y;
    const double cyy = yy_ - y_ * mean_y;
    const double determinant = cxx * cyy - cxy * cxy;
    if (!(determinant > 0.1 * n_ * n_)) return false;
    const double cqx = qx_ - q_ * mean_x;
    const double cqy = qy_ - q_ * mean_y;
    slope_x = (cqx * cyy - cqy * cxy) / determinant;
    slope_y = (cqy * cxx - cqx * cxy) / determinant;
    q0 = q_ / n_ - slope_x * mean_x - slope_y * mean_y;
    return true;
  }

 private:
  double n_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0, yy_ = 0, q_ = 0, qx_ = 0, qy_ = 0;
};

struct DepthReading {
  double x, y, z;  // offset from (u, v) in px; m
};

// A jump is what neither noise nor a steep surface explains: 6 σ, and 4 % of the depth.
double jump_behind(double depth_m, const DepthNoise& noise) {
  return std::max(6 * noise.sigma(depth_m), 0.04 * depth_m);
}

// The nearest depth of a surface that at least three readings show: one or two may fly before everything
// else. 0 when there is none.
double nearest_surface(std::span<const DepthReading> readings, const DepthNoise& noise) {
  const std::size_t least = readings.size() < 3 ? readings.size() : 3;
  double nearest = 0;
  for (std::size_t tries = 0; tries < 3; ++tries) {
    double next = 0;
    for (const DepthReading& reading : readings)
      if (reading.z > nearest && (next == 0 || reading.z < next)) next = reading.z;
    if (next == 0) return 0;
    nearest = next;
    const double end = nearest + jump_behind(nearest, noise);
    std::size_t support = 0;
    for (const DepthReading& reading : readings) support += reading.z >= nearest && reading.z <= end ? 1 : 0;
    if (support >= least) return nearest;
  }
  return 0;
}

}  // namespace

DepthSampler::Window::Window(const DepthSampler& sampler, int x, int y, int reach, int every_px)
    : sampler_(sampler),
      map_(sampler.map_, x, y),
      x_(x),
      y_(y),
      left_(-reach * every_px),
      every_px_(every_px),
      whole_(!kSmallCode && sampler.inside(x + left_, y + left_) && sampler.inside(x - left_, y - left_) &&
             map_.sees(-left_)) {}

void DepthSampler::Window::read_row(int row, std::span<std::uint16_t> units) const {
  const DepthView& depth = sampler_.depth_;
  const int dy = row * every_px_;
  int dx = left_;
  if (!kSmallCode && whole_) {
    map_.for_row(dx, dy, every_px_, units.size(), [&](std::size_t i, int raw_x, int raw_y) {
      units[i] = depth.data[raw_y * depth.stride + raw_x];
    });
    return;
  }
  for (std::uint16_t& reading : units) {
    int raw_x = 0;
    int raw_y = 0;
    const bool seen = sampler_.inside(x_ + dx, y_ + dy) && map_.raw_pixel(dx, dy, raw_x, raw_y);
    reading = seen ? depth.data[raw_y * depth.stride + raw_x] : std::uint16_t{0};
    dx += every_px_;
  }
}

bool DepthSampler::follow(const Vector2& pixel, int guesses, Vector2& located, double& depth_m) const {
  // What is seen where depends on its depth, which is read where it is seen. Most of the displacement is the
  // rotation's, the same for every depth.
  const Pinhole& pinhole = exposure_.pinhole();
  const Vector3 ray = back_project(pinhole, pixel.x(), pixel.y(), 1);
  for (int i = 0; i < guesses; ++i) {
    const double read = at(static_cast<int>(located.x() + 0.5), static_cast<int>(located.y() + 0.5));
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

bool DepthSampler::locate(Vector2& pixel) const {
  if (!exposure_.depth_apart()) return true;
  double depth_m = kUnknownDepth_m;
  Vector2 located = pixel;
  if (!follow(pixel, kGuesses, located, depth_m)) return false;
  pixel = located;
  return located.x() >= 0 && located.y() >= 0 && located.x() < depth_.width && located.y() < depth_.height;
}

DepthSample DepthSampler::sample(double u, double v, int radius) const {
  Vector2 located(u, v);
  if (!locate(located)) return {};
  DepthSample result = sample_window(located.x(), located.y(), radius);
  if (result.depth_m > 0) result.depth_m = at_colour_time(v, located, result.depth_m);
  if (!(result.depth_m > 0)) return {};
  result.located = located;
  return result;
}

DepthSample DepthSampler::sample_window(double u, double v, int radius) const {
  std::array<DepthReading, kMaxWindow> window;
  std::size_t count = 0;
  const int x0 = static_cast<int>(u + 0.5);
  const int y0 = static_cast<int>(v + 0.5);
  if (!inside(x0, y0)) return {};  // at most half a pixel beside the image
  radius = std::min(radius, kMaxRadius);
  const Window readings(*this, x0, y0, radius, 1);
  const auto side = static_cast<std::size_t>(2 * radius + 1);
  std::array<std::uint16_t, 2 * kMaxRadius + 1> row;
  for (int dy = -radius; dy <= radius; ++dy) {
    readings.read_row(dy, std::span(row).first(side));
    for (int dx = -radius; dx <= radius; ++dx) {
      const double z = row[static_cast<std::size_t>(dx + radius)] * depth_.metres_per_unit;
      if (z > 0) window[count++] = {x0 + dx - u, y0 + dy - v, z};
    }
  }
  // Where half the window has no depth, the rest is a rim of bad depth.
  if (2 * count < side * side) return {};
  const double nearest = nearest_surface({window.data(), count}, noise_);
  if (!(nearest > 0)) return {};

  const double jump = jump_behind(nearest, noise_);
  InverseDepthPlane plane;
  double sum = 0;
  std::size_t near_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (window[i].z < nearest || window[i].z > nearest + jump) continue;
    plane.add(window[i].x, window[i].y, 1 / window[i].z);
    sum += window[i].z;
    ++near_count;
  }

  DepthSample result;
  result.on_edge = near_count < count;
  result.depth_m = sum / static_cast<double>(near_count);
  double slope_m = 0;  // per px
  double q0 = 0;
  double slope_x = 0;
  double slope_y = 0;
  if (plane.solve(q0, slope_x, slope_y) && q0 > 0) {
    // The plane may only interpolate: beyond the depths it was fitted to it is not believed.
    result.depth_m = std::clamp(1 / q0, nearest, nearest + jump);
    slope_m = result.depth_m * result.depth_m * sqrt(slope_x * slope_x + slope_y * slope_y);
  }
  const double sigma_d = noise_.sigma(result.depth_m);
  const double sigma_registration = slope_m * noise_.registration_px;
  result.sigma_m = sqrt(sigma_d * sigma_d + sigma_registration * sigma_registration);
  // The nearer surface's own depth is less sure where the window is mixed.
  if (result.on_edge) result.sigma_m *= 2;
  return result;
}

}  // namespace plvo
