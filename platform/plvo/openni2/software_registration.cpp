// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/software_registration.hpp"

#include <algorithm>
#include <cstddef>

#include "plvo/math/trigonometry.hpp"

namespace plvo {

Pinhole pinhole_from_fov(int width, int height, double fov_x_rad, double fov_y_rad) {
  const auto focal = [](int size, double fov_rad) {
    return 0.5 * size * plvo::cos(0.5 * fov_rad) / plvo::sin(0.5 * fov_rad);
  };
  Pinhole pinhole;
  pinhole.fx = focal(width, fov_x_rad);
  pinhole.fy = focal(height, fov_y_rad);
  pinhole.cx = 0.5 * (width - 1);
  pinhole.cy = 0.5 * (height - 1);
  return pinhole;
}

void SoftwareRegistration::reset(const Pinhole& depth, const CameraModel& colour, double metres_per_unit) {
  colour_ = colour;
  metres_per_unit_ = metres_per_unit;
  x_.resize(static_cast<std::size_t>(colour.width));
  y_.resize(static_cast<std::size_t>(colour.height));
  for (int u = 0; u < colour.width; ++u) x_[static_cast<std::size_t>(u)] = (u - depth.cx) / depth.fx;
  for (int v = 0; v < colour.height; ++v) y_[static_cast<std::size_t>(v)] = (v - depth.cy) / depth.fy;
}

void SoftwareRegistration::warp(const std::uint16_t* depth, std::uint16_t* registered) const {
  const int width = colour_.width;
  const int height = colour_.height;
  const bool lens = !colour_.distortion.is_zero();
  std::fill_n(registered, static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
              std::uint16_t{0});
  for (int v = 0; v < height; ++v) {
    const std::uint16_t* row = depth + static_cast<std::ptrdiff_t>(v) * width;
    for (int u = 0; u < width; ++u) {
      const std::uint16_t d = row[u];
      if (d == 0) continue;
      const double x = x_[static_cast<std::size_t>(u)] - kBaseline_m / (d * metres_per_unit_);
      Vector2 px(colour_.pinhole.fx * x + colour_.pinhole.cx,
                 colour_.pinhole.fy * y_[static_cast<std::size_t>(v)] + colour_.pinhole.cy);
      // Far outside the image the lens polynomial may fold back into it, so only points near the image of the
      // pinhole are used.
      if (!(px.x() > -width && px.x() < 2 * width && px.y() > -height && px.y() < 2 * height)) continue;
      if (lens) px = distort_pixel(colour_, px);
      if (!(px.x() >= -0.5 && px.x() < width - 0.5 && px.y() >= -0.5 && px.y() < height - 0.5)) continue;
      const int to_u = static_cast<int>(px.x() + 0.5);
      const int to_v = static_cast<int>(px.y() + 0.5);
      std::uint16_t& target = registered[static_cast<std::ptrdiff_t>(to_v) * width + to_u];
      if (target == 0 || d < target) target = d;
    }
  }
}

}  // namespace plvo
