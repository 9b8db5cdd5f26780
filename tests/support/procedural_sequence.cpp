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

// A surface coordinate in units of `size`, counted from so far before the room that it is positive, and to
// cut off the fraction is to round down.
constexpr std::int32_t kBefore = 64;
double units(double coordinate, double size) { return coordinate * (1 / size) + kBefore; }

// Grey levels of the walls: tiles of two sizes, and a dark strip every 0.9 m. Remembers the last answer:
// neighbours mostly lie on the same tile.
class Walls {
 public:
  // At the surface coordinates (s, t).
  int grey(std::uint32_t wall, double s, double t) {
    const double strips = units(s, 0.9);
    if (strips - static_cast<std::int32_t>(strips) < 0.045) return 24;
    const Tiles tiles{
        wall,
        {static_cast<std::int32_t>(units(s, 0.31)), static_cast<std::int32_t>(units(t, 0.31))},
        {static_cast<std::int32_t>(units(s, 0.085)), static_cast<std::int32_t>(units(t, 0.085))}};
    if (tiles != last_) {
      last_ = tiles;
      grey_ = grey_of(tiles);
    }
    return grey_;
  }

 private:
  struct Tiles {
    std::uint32_t wall = ~0U;
    std::int32_t large[2] = {}, small[2] = {};
    bool operator==(const Tiles&) const = default;
  };

  static int grey_of(const Tiles& tiles) {
    const auto hash_of = [&](const std::int32_t(&cell)[2], std::uint32_t salt) {
      return hash(tiles.wall * 16 + salt, static_cast<std::uint32_t>(cell[0] - kBefore),
                  static_cast<std::uint32_t>(cell[1] - kBefore));
    };
    int grey = 90 + static_cast<int>(hash_of(tiles.large, 1) % 70);
    const std::uint32_t small = hash_of(tiles.small, 2);
    if (small % 5 == 0) grey += static_cast<int>(small >> 8) % 120 - 60;
    return std::clamp(grey, 10, 245);
  }

  Tiles last_;
  int grey_ = 0;
};

// Plain numbers in the place of Eigen's: a sanitizer makes a call of each access to a matrix.
struct Ray {
  double along[3];
};

Ray rotated(const double (&R)[3][3], const Ray& ray) {
  const auto row = [&](int i) {
    return R[i][0] * ray.along[0] + (R[i][1] * ray.along[1] + R[i][2] * ray.along[2]);
  };
  return {{row(0), row(1), row(2)}};
}
Ray operator+(const Ray& a, const Ray& b) {
  return {{a.along[0] + b.along[0], a.along[1] + b.along[1], a.along[2] + b.along[2]}};
}

// The room around one place of the camera.
class View {
 public:
  explicit View(const Vector3& origin) {
    for (int k = 0; k < 3; ++k) {
      origin_[k] = origin(k);
      low_[k] = kLow(k);
      high_[k] = kHigh(k);
      to_low_[k] = kLow(k) - origin(k);
      to_high_[k] = kHigh(k) - origin(k);
    }
  }

  // The wall that a ray meets: the axis across it, and how far away it is, in units of the ray.
  struct Hit {
    int axis = 0;
    double distance = 0;
  };
  Hit cast(const Ray& ray) const {
    Hit nearest{0, 1e9};
    for (int k = 0; k < 3; ++k) {
      if (ray.along[k] == 0) continue;
      const double d = distance(ray, k);
      if (d < nearest.distance) nearest = {k, d};
    }
    return nearest;
  }

  // Grey level of a ray beside one that met the wall across `axis`: most rays meet the same wall.
  int grey(const Ray& ray, int axis) {
    double s = 0, t = 0;
    if (!meets(ray, axis, distance(ray, axis), s, t)) {
      const Hit hit = cast(ray);
      axis = hit.axis;
      (void)meets(ray, axis, hit.distance, s, t);
    }
    return walls_.grey(static_cast<std::uint32_t>(2 * axis + (ray.along[axis] > 0 ? 1 : 0)), s, t);
  }

 private:
  double distance(const Ray& ray, int axis) const {
    return (ray.along[axis] > 0 ? to_high_[axis] : to_low_[axis]) / ray.along[axis];
  }
  // (s, t): where the ray is at distance d, along the two other axes; false if that is outside the room.
  bool meets(const Ray& ray, int axis, double d, double& s, double& t) const {
    const int i = axis < 2 ? axis + 1 : 0;
    const int j = i < 2 ? i + 1 : 0;
    s = origin_[i] + d * ray.along[i];
    t = origin_[j] + d * ray.along[j];
    return s > low_[i] && s < high_[i] && t > low_[j] && t < high_[j];
  }

  double origin_[3], low_[3], high_[3];
  double to_low_[3], to_high_[3];
  Walls walls_;
};

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

RgbdFrame ProceduralRenderer::render(int i, double mirror_m) {
  const Se3 T = T_world_camera(i);
  View view(T.t);
  // Four samples a pixel, so that edges have a place below the pixel.
  double R[3][3];
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) R[row][column] = T.R(row, column);
  Ray offsets[4];
  for (int sample = 0; sample < 4; ++sample)
    offsets[sample] = rotated(R, {{(sample % 2 == 0 ? -0.25 : 0.25) / camera_.pinhole.fx,
                                   (sample < 2 ? -0.25 : 0.25) / camera_.pinhole.fy, 0}});
  for (std::size_t k = 0; k < rays_.size(); ++k) {
    const double* const in_camera = rays_[k].data();
    const Ray ray = rotated(R, {{in_camera[0], in_camera[1], in_camera[2]}});
    const View::Hit hit = view.cast(ray);
    int grey = 0;
    for (const Ray& offset : offsets) grey += view.grey(ray + offset, hit.axis);
    const std::uint32_t noise = hash(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k), 7);
    grey = std::clamp((grey + 2) / 4 + static_cast<int>(noise % 5) - 2, 0, 255);
    for (int channel = 0; channel < 3; ++channel)
      colour_[3 * k + static_cast<std::size_t>(channel)] =
          static_cast<std::uint8_t>(std::max(0, grey - 3 * channel));

    // The ray has z = 1, so its parameter is the depth. Far things and one pixel in 64 have none.
    const double to_mirror_m = ray.along[2] > 0 ? (mirror_m - T.t.z()) / ray.along[2] : kNoMirror;
    const auto millimetres = static_cast<int>(std::min(hit.distance, to_mirror_m) * 1000 + 0.5);
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
