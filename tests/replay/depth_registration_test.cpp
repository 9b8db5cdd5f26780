// SPDX-License-Identifier: Apache-2.0
// Compares registered depth with the depth along the rays of the colour camera: a slanted floor, and a box
// before a wall.
#include "plvo/replay/images/depth_registration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace plvo {
namespace {

constexpr double kUnit_m = 0.001;

// The ray parameter where the ray from `origin` along `direction` (z = 1 in its own camera) meets n · X =
// distance.
double meet(const Vector3& n, double distance, const Vector3& origin, const Vector3& direction) {
  return (distance - n.dot(origin)) / n.dot(direction);
}

struct Pair {
  CameraModel colour;
  DepthCamera depth;
  int width = 0, height = 0;  // of depth
  Se3 T_camera_depth() const {
    return {to_rotation({depth.qx, depth.qy, depth.qz, depth.qw}), {depth.tx, depth.ty, depth.tz}};
  }
  // The depth image of a plane that is given in the frame of colour.
  std::vector<std::uint16_t> see(const Vector3& n, double distance) const {
    std::vector<std::uint16_t> image;
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) {
        const Vector3 ray = T_camera_depth().R * back_project(depth.pinhole, u, v, 1);
        const double d = meet(n, distance, T_camera_depth().t, ray);
        image.push_back(d > 0 && d < 60 ? static_cast<std::uint16_t>(d / kUnit_m + 0.5) : std::uint16_t{0});
      }
    return image;
  }
  std::vector<std::uint16_t> registered(const std::vector<std::uint16_t>& image) const {
    DepthRegistration registration;
    registration.init(colour, {1, colour.width, colour.height}, depth, width, height, kUnit_m);
    std::vector<std::uint16_t> out(static_cast<std::size_t>(colour.width * colour.height), 7);
    registration.warp(image.data(), out.data());
    return out;
  }
};

Pair pair_with(const Distortion& lens) {
  Pair pair;
  pair.colour = {320, 240, {260, 262, 158, 121}, lens};
  pair.width = 160;
  pair.height = 144;
  pair.depth = {true, {118, 118, 80, 72}, 0.032, -0.002, 0.004, 0.01, -0.005, 0.002, 0.99993};
  return pair;
}

TEST(DepthRegistration, MatchesColourRaysOnASlantedFloor) {
  const Vector3 n = Vector3(0.1, 0.6, 1).normalized();
  for (const Distortion& lens : {Distortion{}, Distortion{-0.2, 0.05, 0.001, -0.001, 0},
                                 Distortion{.k1 = 0.02, .k2 = -0.01, .model = LensModel::kEquidistant}}) {
    const Pair pair = pair_with(lens);
    const std::vector<std::uint16_t> out = pair.registered(pair.see(n, 1.5));
    int covered = 0, all = 0;
    double worst = 0;
    for (int v = 0; v < 240; ++v)
      for (int u = 0; u < 320; ++u) {
        const Vector2 ideal = undistort_pixel(pair.colour, Vector2(u, v));
        const Vector3 ray = back_project(pair.colour.pinhole, ideal.x(), ideal.y(), 1);
        const double expected = meet(n, 1.5, Vector3::Zero(), ray);
        const Vector2 from = project(pair.depth.pinhole, pair.T_camera_depth().inverse() * (expected * ray));
        if (from.x() < 0 || from.y() < 0 || from.x() > pair.width - 1 || from.y() > pair.height - 1) continue;
        ++all;
        const double z = out[static_cast<std::size_t>(v * 320 + u)] * kUnit_m;
        if (z == 0) continue;
        ++covered;
        worst = std::max(worst, std::abs(z - expected) / expected);
      }
    EXPECT_GT(all, 320 * 240 * 9 / 10);
    EXPECT_GT(covered, all * 99 / 100);
    // A depth pixel is 2.2 colour pixels wide: on this slope its edge is up to 0.8 % nearer or farther than
    // its middle.
    EXPECT_LT(worst, 0.012);
  }
}

TEST(DepthRegistration, KeepsTheNearestDepth) {
  const Pair pair = pair_with({});
  const Vector3 ahead(0, 0, 1);
  std::vector<std::uint16_t> image = pair.see(ahead, 3);
  const std::vector<std::uint16_t> box = pair.see(ahead, 0.8);
  for (int v = 40; v < 100; ++v)
    for (int u = 60; u < 90; ++u) {
      const auto i = static_cast<std::size_t>(v * 160 + u);
      image[i] = box[i];
    }
  const std::vector<std::uint16_t> out = pair.registered(image);
  int on_box = 0;
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u) {
      const std::uint16_t z = out[static_cast<std::size_t>(v * 320 + u)];
      // The box is visible where its plane projects back into its part of the depth image.
      const Vector3 p = back_project(pair.colour.pinhole, u, v, 0.8);
      const Vector2 from = project(pair.depth.pinhole, pair.T_camera_depth().inverse() * p);
      const bool inside = from.x() > 60 && from.x() < 89 && from.y() > 40 && from.y() < 99;
      const bool outside = from.x() < 58.5 || from.x() > 90.5 || from.y() < 38.5 || from.y() > 100.5;
      if (inside) {
        ASSERT_NEAR(z, 800, 2) << u << ' ' << v;
      }
      if (outside && z != 0) {
        ASSERT_NEAR(z, 3000, 2) << u << ' ' << v;
      }
      on_box += inside ? 1 : 0;
    }
  EXPECT_GT(on_box, 5000);
}

TEST(DepthRegistration, KeepsEmptyDepthEmpty) {
  const Pair pair = pair_with({});
  const std::vector<std::uint16_t> none(static_cast<std::size_t>(pair.width * pair.height), 0);
  const std::vector<std::uint16_t> out = pair.registered(none);
  EXPECT_EQ(std::count(out.begin(), out.end(), 0), 320 * 240);
}

// A plane that slants right and down. The images are scaled down by even and odd factors, with a few columns
// and rows left over. Depth has the size of colour, or half of it.
TEST(DepthRegistration, ScaledDownTakesAMiddlePixelWithoutShift) {
  const auto plane = [](double u, double v) { return 2000 + 6 * u - 4 * v; };
  for (const int factor : {2, 3, 4})
    for (const int size : {1, 2}) {
      const WholeImage whole{factor, 122, 86};
      const CameraModel colour = {whole.width / factor, whole.height / factor, {100, 100, 30, 20}, {}};
      const int width = whole.width / size, height = whole.height / size;
      std::vector<std::uint16_t> depth;
      for (int v = 0; v < height; ++v)
        for (int u = 0; u < width; ++u) depth.push_back(static_cast<std::uint16_t>(plane(u, v)));
      DepthRegistration registration;
      registration.init(colour, whole, {}, width, height, kUnit_m);
      std::vector<std::uint16_t> out(static_cast<std::size_t>(colour.width * colour.height));
      registration.warp(depth.data(), out.data());
      double sum = 0, worst = 0;
      for (int y = 0; y < colour.height; ++y)
        for (int x = 0; x < colour.width; ++x) {
          // The middle of the colour pixel, in pixels of depth.
          const double u = (x + 0.5) * factor * width / whole.width - 0.5;
          const double v = (y + 0.5) * factor * height / whole.height - 0.5;
          const double error = out[static_cast<std::size_t>(y * colour.width + x)] - plane(u, v);
          sum += error;
          worst = std::max(worst, std::abs(error));
        }
      EXPECT_LE(worst, 0.5 * (6 + 4) + 1e-9) << factor << ' ' << size;
      EXPECT_NEAR(sum / (colour.width * colour.height), 0, 0.3) << factor << ' ' << size;
    }
}

TEST(DepthRegistration, SameViewRequiresSameAspectRatio) {
  EXPECT_TRUE(DepthRegistration::same_view(1280, 720, 640, 360));
  EXPECT_TRUE(DepthRegistration::same_view(640, 480, 1280, 960));
  EXPECT_TRUE(DepthRegistration::same_view(1920, 1080, 848, 477));
  EXPECT_FALSE(DepthRegistration::same_view(1296, 968, 640, 480)) << "ScanNet's two cameras";
  EXPECT_FALSE(DepthRegistration::same_view(1280, 720, 640, 480));
}

}  // namespace
}  // namespace plvo
