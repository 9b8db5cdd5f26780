// SPDX-License-Identifier: Apache-2.0
#include "procedural_sequence.hpp"

#include <algorithm>

namespace plvo {
namespace {

// The room: x and z across, y down; the camera starts at the origin and looks along z. Metres.
const Vector3 kLow(-1.05, -0.72, -2.0);
const Vector3 kHigh(1.2, 0.7, 2.6);

std::uint32_t hash(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  std::uint32_t h = a * 0x9e3779b1U ^ (b + 0x7f4a7c15U) * 0x85ebca77U ^ (c + 0x165667b1U) * 0xc2b2ae3dU;
  h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
  h = (h ^ (h >> 12)) * 0x297a2d39U;
  return h ^ (h >> 15);
}

std::int32_t floor_to_int(double x) {
  const auto truncated = static_cast<std::int32_t>(x);
  return x < truncated ? truncated - 1 : truncated;
}

// Grey level of a wall at the surface coordinates (s, t): tiles of two sizes, and a dark strip every 0.9 m.
int wall_grey(std::uint32_t wall, double s, double t) {
  const double along = s / 0.9 - floor_to_int(s / 0.9);
  if (along < 0.045) return 24;
  const auto cell = [&](double size, std::uint32_t salt) {
    return hash(wall * 16 + salt, static_cast<std::uint32_t>(floor_to_int(s / size)),
                static_cast<std::uint32_t>(floor_to_int(t / size)));
  };
  int grey = 90 + static_cast<int>(cell(0.31, 1) % 70);
  const std::uint32_t small = cell(0.085, 2);
  if (small % 5 == 0) grey += static_cast<int>(small >> 8) % 120 - 60;
  return std::clamp(grey, 10, 245);
}

struct Hit {
  double distance;  // in units of the ray
  int grey;
};

Hit cast(const Vector3& origin, const Vector3& ray) {
  int axis = 0;
  double nearest = 1e9;
  for (int k = 0; k < 3; ++k) {
    if (ray(k) == 0) continue;
    const double d = ((ray(k) > 0 ? kHigh(k) : kLow(k)) - origin(k)) / ray(k);
    if (d < nearest) {
      nearest = d;
      axis = k;
    }
  }
  const Vector3 p = origin + nearest * ray;
  const auto wall = static_cast<std::uint32_t>(2 * axis + (ray(axis) > 0 ? 1 : 0));
  return {nearest, wall_grey(wall, p((axis + 1) % 3), p((axis + 2) % 3))};
}

}  // namespace

bool ProceduralRenderer::init(int width, int height, std::span<std::byte> memory) {
  const double scale = width / 640.0;
  camera_.width = width;
  camera_.height = height;
  camera_.pinhole = {520 * scale, 518 * scale, 322 * scale, 236 * scale};
  camera_.distortion = {0.05, -0.12, 0.0008, -0.0005, 0.06};
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  Arena arena(memory);
  rays_ = arena.take<Vector3>("rays", count);
  colour_ = arena.take<std::uint8_t>("colour", 3 * count);
  depth_ = arena.take<std::uint16_t>("depth", count);
  if (arena.exhausted()) return false;
  std::size_t k = 0;
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const Vector2 ideal = undistort_pixel(camera_, Vector2(u, v));
      rays_[k++] = back_project(camera_.pinhole, ideal.x(), ideal.y(), 1);
    }
  return true;
}

Se3 ProceduralRenderer::T_world_camera(int i) {
  // A slow arc that sways, so that every degree of freedom moves.
  const int phase = i % 16 < 8 ? i % 8 : 8 - i % 8;
  return {rotation_exp(Vector3(0.004 * phase, 0.012 * i, -0.003 * phase)),
          Vector3(0.011 * i, 0.004 * phase, 0.007 * i)};
}

RgbdFrame ProceduralRenderer::render(int i) {
  const Se3 T = T_world_camera(i);
  const double quarter_x = 0.25 / camera_.pinhole.fx;
  const double quarter_y = 0.25 / camera_.pinhole.fy;
  for (std::size_t k = 0; k < rays_.size(); ++k) {
    // Four samples a pixel, so that edges have a place below the pixel.
    int grey = 0;
    for (int sample = 0; sample < 4; ++sample) {
      const Vector3 offset((sample % 2 == 0 ? -1 : 1) * quarter_x, (sample < 2 ? -1 : 1) * quarter_y, 0);
      grey += cast(T.t, T.R * (rays_[k] + offset)).grey;
    }
    const std::uint32_t noise = hash(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k), 7);
    grey = std::clamp((grey + 2) / 4 + static_cast<int>(noise % 5) - 2, 0, 255);
    for (int channel = 0; channel < 3; ++channel)
      colour_[3 * k + static_cast<std::size_t>(channel)] =
          static_cast<std::uint8_t>(std::max(0, grey - 3 * channel));

    // The ray has z = 1, so its parameter is the depth. Far things and one pixel in 64 have none.
    const double z = cast(T.t, T.R * rays_[k]).distance;
    const auto millimetres = static_cast<int>(z * 1000 + 0.5);
    const int step = 1 + millimetres * millimetres / 1'200'000;
    const int jitter = static_cast<int>((noise >> 8) % 3) - 1;
    const bool hole = millimetres > 4000 || (noise >> 16) % 64 == 0;
    depth_[k] = static_cast<std::uint16_t>(hole ? 0 : (millimetres / step + jitter) * step);
  }
  return frame(i);
}

RgbdFrame ProceduralRenderer::render_dark(int i) {
  std::fill(colour_.begin(), colour_.end(), std::uint8_t{2});
  std::fill(depth_.begin(), depth_.end(), std::uint16_t{0});
  return frame(i);
}

RgbdFrame ProceduralRenderer::frame(int i) const {
  RgbdFrame frame;
  frame.stamp_ns = stamp_ns(i);
  frame.depth_stamp_ns = frame.stamp_ns;
  frame.colour = {colour_.data(), camera_.width, camera_.height, 3 * camera_.width, PixelFormat::kRgb8};
  frame.depth = {depth_.data(), camera_.width, camera_.height, camera_.width, 0.001};
  return frame;
}

}  // namespace plvo
