// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/detectors/view.hpp"

#include <cmath>

namespace plvo::bench {
namespace {

// The smallest depth in the surrounding 5×5 pixels; 0 if none of them has depth.
double depth_near(const View& view, const Vector2& pixel) {
  float nearest = 0;
  const int u = static_cast<int>(std::lround(pixel.x()));
  const int v = static_cast<int>(std::lround(pixel.y()));
  for (int y = std::max(v - 2, 0); y <= std::min(v + 2, view.height - 1); ++y) {
    for (int x = std::max(u - 2, 0); x <= std::min(u + 2, view.width - 1); ++x) {
      const float depth = view.depth_m[static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                                       static_cast<std::size_t>(x)];
      if (depth > 0 && (nearest == 0 || depth < nearest)) nearest = depth;
    }
  }
  return nearest;
}

}  // namespace

bool carry(const Pinhole& pinhole, const View& from, const View& to, const Vector2& pixel, Vector2& carried) {
  constexpr double kHidden = 0.05;  // fraction of the depth: a surface that is nearer by more hides this one
  const double depth = depth_near(from, pixel);
  if (depth <= 0) return false;
  const Vector3 p = to.T_world_camera.inverse() *
                    (from.T_world_camera * back_project(pinhole, pixel.x(), pixel.y(), depth));
  if (p.z() <= 0.1) return false;
  carried = project(pinhole, p);
  if (carried.x() < 0 || carried.y() < 0 || carried.x() > to.width - 1 || carried.y() > to.height - 1)
    return false;
  return std::abs(depth_near(to, carried) - p.z()) <= kHidden * p.z();
}

double step_across(const std::vector<std::uint8_t>& grey, int width, int height, const Vector2& at,
                   const Vector2& normal) {
  constexpr double kReach_px = 2.5;
  if (at.x() < kReach_px || at.y() < kReach_px || at.x() >= width - 1 - kReach_px ||
      at.y() >= height - 1 - kReach_px)
    return 0;
  const auto value = [&](double offset) {
    const Vector2 p = at + offset * normal;
    const int x = static_cast<int>(p.x());
    const int y = static_cast<int>(p.y());
    const double u = p.x() - x;
    const double v = p.y() - y;
    const std::uint8_t* top = grey.data() + static_cast<std::ptrdiff_t>(y) * width + x;
    return (top[0] * (1 - u) + top[1] * u) * (1 - v) + (top[width] * (1 - u) + top[width + 1] * u) * v;
  };
  return 0.5 * (value(1.5) + value(kReach_px) - value(-1.5) - value(-kReach_px));
}

}  // namespace plvo::bench
