// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/images/depth_registration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace plvo {
namespace {

// For each colour pixel, the depth pixel that covers its centre; a pixel of `colour` is `factor` pixels of
// `whole` wide. turn: 0 or 1 takes the one before or after a centre that lies between two.
std::vector<int> covering(int colour, int factor, int whole, int depth, int turn) {
  std::vector<int> index(static_cast<std::size_t>(colour));
  for (int i = 0; i < colour; ++i) {
    const std::int64_t middle = (2 * std::int64_t{i} + 1) * factor * depth;
    const std::int64_t unit = 2 * std::int64_t{whole};
    index[static_cast<std::size_t>(i)] =
        static_cast<int>(middle / unit - (middle % unit == 0 && turn == 0 ? 1 : 0));
  }
  return index;
}

}  // namespace

bool DepthRegistration::same_view(int colour_width, int colour_height, int depth_width, int depth_height) {
  const std::int64_t difference =
      std::int64_t{colour_height} * depth_width - std::int64_t{depth_height} * colour_width;
  return std::abs(difference) <= colour_width;
}

void DepthRegistration::init(const CameraModel& colour, const WholeImage& whole, const DepthCamera& depth,
                             int depth_width, int depth_height, double metres_per_unit) {
  colour_ = colour;
  depth_ = depth;
  T_camera_depth_ = {to_rotation({depth.qx, depth.qy, depth.qz, depth.qw}), {depth.tx, depth.ty, depth.tz}};
  width_ = depth_width;
  height_ = depth_height;
  metres_per_unit_ = metres_per_unit;
  for (int turn = 0; turn < 2; ++turn) {
    column_[turn] = covering(colour.width, whole.factor, whole.width, depth_width, turn);
    row_[turn] = covering(colour.height, whole.factor, whole.height, depth_height, turn);
  }
}

void DepthRegistration::warp(const std::uint16_t* depth, std::uint16_t* registered) const {
  if (depth_.known) {
    warp_own_camera(depth, registered);
  } else {
    warp_same_view(depth, registered);
  }
}

void DepthRegistration::warp_same_view(const std::uint16_t* depth, std::uint16_t* registered) const {
  for (int y = 0; y < colour_.height; ++y) {
    for (int x = 0; x < colour_.width; ++x) {
      const int turn = (x + y) & 1;
      const std::ptrdiff_t row = row_[turn][static_cast<std::size_t>(y)];
      *registered++ = depth[row * width_ + column_[turn][static_cast<std::size_t>(x)]];
    }
  }
}

void DepthRegistration::warp_own_camera(const std::uint16_t* depth, std::uint16_t* registered) const {
  const int width = colour_.width;
  const int height = colour_.height;
  std::fill_n(registered, static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
              std::uint16_t{0});
  constexpr double kOverlap_px = 0.01;  // avoids seams by rounding
  constexpr double kMost_px = 64;       // limits the size of a depth pixel close to the colour camera
  const double scale_x = 0.5 * colour_.pinhole.fx / depth_.pinhole.fx;
  const double scale_y = 0.5 * colour_.pinhole.fy / depth_.pinhole.fy;
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) {
      const std::uint16_t units = depth[static_cast<std::ptrdiff_t>(v) * width_ + u];
      if (units == 0) continue;
      const double d = units * metres_per_unit_;
      const Vector3 p = T_camera_depth_ * back_project(depth_.pinhole, u, v, d);
      if (!(p.z() > 0)) continue;
      Vector2 px = project(colour_.pinhole, p);
      // Far outside the image, the distortion may map back into it.
      if (!(px.x() > -width && px.x() < 2 * width && px.y() > -height && px.y() < 2 * height)) continue;
      if (!colour_.distortion.is_zero()) px = distort_pixel(colour_, px);
      const double seen_z = p.z() / metres_per_unit_ + 0.5;
      if (!(seen_z >= 1 && seen_z < 65536)) continue;
      const auto z = static_cast<std::uint16_t>(seen_z);
      const double half_x = std::min(scale_x * d / p.z(), kMost_px) + kOverlap_px;
      const double half_y = std::min(scale_y * d / p.z(), kMost_px) + kOverlap_px;
      if (!(px.x() + half_x >= 0 && px.x() - half_x <= width - 1 && px.y() + half_y >= 0 &&
            px.y() - half_y <= height - 1))
        continue;
      const int left = std::max(0, static_cast<int>(std::ceil(px.x() - half_x)));
      const int right = std::min(width - 1, static_cast<int>(std::floor(px.x() + half_x)));
      const int top = std::max(0, static_cast<int>(std::ceil(px.y() - half_y)));
      const int bottom = std::min(height - 1, static_cast<int>(std::floor(px.y() + half_y)));
      for (int y = top; y <= bottom; ++y) {
        std::uint16_t* row = registered + static_cast<std::ptrdiff_t>(y) * width;
        for (int x = left; x <= right; ++x)
          if (row[x] == 0 || z < row[x]) row[x] = z;
      }
    }
  }
}

}  // namespace plvo
