// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/software_registration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "plvo/base/random.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

TEST(SoftwareRegistration, FocalLengthFollowsFromTheFieldOfView) {
  const Pinhole pinhole = pinhole_from_fov(640, 480, 62.0 * kPi / 180, 48.6 * kPi / 180);
  EXPECT_NEAR(pinhole.fx, 320 / std::tan(31.0 * kPi / 180), 1e-9);
  EXPECT_NEAR(pinhole.fy, 240 / std::tan(24.3 * kPi / 180), 1e-9);
  EXPECT_EQ(pinhole.cx, 319.5);
  EXPECT_EQ(pinhole.cy, 239.5);
}

// Reference implementation: transforms every point with the core's own back-projection, projection and lens
// model. If several points fall into a pixel, the smallest depth remains.
std::map<int, std::uint16_t> reference(const std::vector<std::uint16_t>& depth, const Pinhole& from,
                                       const CameraModel& to) {
  std::map<int, std::uint16_t> image;
  for (int v = 0; v < to.height; ++v) {
    for (int u = 0; u < to.width; ++u) {
      const std::uint16_t d = depth[static_cast<std::size_t>(v * to.width + u)];
      if (d == 0) continue;
      const Vector3 p_depth = back_project(from, u, v, d * 0.001);
      const Vector3 p_colour = p_depth - Vector3(0.025, 0, 0);
      const Vector2 px = distort_pixel(to, project(to.pinhole, p_colour));
      const int x = static_cast<int>(std::floor(px.x() + 0.5));
      const int y = static_cast<int>(std::floor(px.y() + 0.5));
      if (x < 0 || y < 0 || x >= to.width || y >= to.height) continue;
      const auto [at, fresh] = image.try_emplace(y * to.width + x, d);
      if (!fresh && d < at->second) at->second = d;
    }
  }
  return image;
}

void compare(const CameraModel& colour) {
  Random random(11);
  const Pinhole depth_pinhole = pinhole_from_fov(160, 120, 1.02, 0.79);
  std::vector<std::uint16_t> depth(160 * 120), warped(160 * 120, 99);
  for (auto& d : depth) d = static_cast<std::uint16_t>(random.below(5) == 0 ? 0 : 400 + random.below(5000));
  SoftwareRegistration registration;
  registration.reset(depth_pinhole, colour, 0.001);
  registration.warp(depth.data(), warped.data());
  const auto expected = reference(depth, depth_pinhole, colour);
  ASSERT_GT(expected.size(), 5000u);
  int different = 0;
  for (int i = 0; i < 160 * 120; ++i) {
    const auto at = expected.find(i);
    different += (at == expected.end() ? 0 : at->second) != warped[static_cast<std::size_t>(i)];
  }
  // The two implementations round at different places, so a point on the border of two pixels may fall into
  // either.
  EXPECT_LE(different, 4);
}

TEST(SoftwareRegistration, AgreesWithTheReferenceForAPinhole) {
  CameraModel colour;
  colour.width = 160;
  colour.height = 120;
  colour.pinhole = {131.0, 131.5, 80.2, 59.1};
  compare(colour);
}

TEST(SoftwareRegistration, AgreesWithTheReferenceForALens) {
  CameraModel colour;
  colour.width = 160;
  colour.height = 120;
  colour.pinhole = {131.0, 131.5, 80.2, 59.1};
  colour.distortion = {0.15, -0.3, 0.001, -0.002, 0.1};
  ASSERT_TRUE(colour.validate().ok());
  compare(colour);
}

// At 1 m, 25 mm correspond to a shift of fx · 0.025 px to the left. The nearer of two surfaces hides the
// farther.
TEST(SoftwareRegistration, NearSurfacesMoveFartherAndHide) {
  CameraModel colour;
  colour.pinhole = {520, 520, 319.5, 239.5};
  std::vector<std::uint16_t> depth(640 * 480, 0), warped(640 * 480, 0);
  depth[200 * 640 + 300] = 1000;
  depth[300 * 640 + 326] = 500;   // lands 26 px to the left
  depth[300 * 640 + 313] = 1000;  // lands 13 px to the left: in the same pixel
  SoftwareRegistration registration;
  registration.reset(colour.pinhole, colour, 0.001);
  registration.warp(depth.data(), warped.data());
  EXPECT_EQ(warped[200 * 640 + 287], 1000);
  EXPECT_EQ(warped[300 * 640 + 300], 500);
  EXPECT_EQ(std::count(warped.begin(), warped.end(), 0), 640 * 480 - 2);
}

}  // namespace
}  // namespace plvo
