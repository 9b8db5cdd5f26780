// SPDX-License-Identifier: Apache-2.0
// Compares depth along a stretch with its definition at every position: DepthSampler::locate gives the
// position in the depth image, and the map applies the lens to it.
#include "plvo/image/depth_stretch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plvo/base/arena.hpp"
#include "plvo/base/random.hpp"

namespace plvo {
namespace {

constexpr int kRawWidth = 640;
constexpr int kRawHeight = 480;
constexpr double kRawUnit = 1e-4;  // m

CameraModel rolling_camera(const Distortion& lens) {
  CameraModel camera{kRawWidth, kRawHeight, {525, 528, 316, 248}, lens};
  camera.depth_timing.known = true;
  camera.depth_timing.readout_s = 0.03;
  camera.readout_s = 0.026;
  return camera;
}

// A raw depth image computed by a function of the raw pixel, and the undistortion map of the camera.
struct RawScene {
  template <typename Function>
  RawScene(const CameraModel& camera, Function depth_m)
      : units(kRawWidth * kRawHeight), memory(kRawWidth * kRawHeight * 2), arena(memory) {
    for (int y = 0; y < kRawHeight; ++y)
      for (int x = 0; x < kRawWidth; ++x)
        units[static_cast<std::size_t>(y * kRawWidth + x)] =
            static_cast<std::uint16_t>(std::floor(depth_m(x, y) / kRawUnit + 0.5));
    map.allocate(arena, kRawWidth, kRawHeight);
    map.init(camera);
  }
  DepthSampler sampler(const Exposure& exposure) const {
    return {{units.data(), kRawWidth, kRawHeight, kRawWidth, kRawUnit}, map, DepthNoise{}, exposure};
  }
  std::vector<std::uint16_t> units;
  UndistortionMap map;

 private:
  std::vector<std::byte> memory;
  Arena arena;
};

// No lens, a Kinect's, and one with distortion of the opposite sign.
const Distortion kStretchLenses[] = {{}, {0.26, -0.95, -0.005, 0.003, 1.16}, {-0.1, 0.02, 0, 0, 0}};

struct Line {
  Vector2 first, step, across;
  int count;
};

Line random_line(Random& random) {
  for (;;) {
    const Vector2 a(kRawWidth * random.uniform(), kRawHeight * random.uniform());
    const Vector2 b(kRawWidth * random.uniform(), kRawHeight * random.uniform());
    const double length = (b - a).norm();
    if (length < 5) continue;
    const Vector2 along = (b - a) / length;
    const int count = std::min(2 + static_cast<int>(length / (1 + 2 * random.uniform())), 100);
    return {a, (b - a) / (count - 1), {-along.y(), along.x()}, count};
  }
}

Vector6 random_velocity(Random& random) {
  Vector6 velocity;
  for (int k = 0; k < 6; ++k) velocity[k] = (k < 3 ? 0.6 : 1.2) * (2 * random.uniform() - 1);
  return velocity;
}

// The camera moves fast in front of a plane. The stretch must read the depth at that position within its
// change over one pixel (half of this is rounding), and convert it to the time of colour as the sampler does.
TEST(DepthStretch, ReadsWhereTheDepthImageShowsIt) {
  Random random(5);
  int read = 0;
  int without_depth = 0;
  for (const Distortion& lens : kStretchLenses) {
    const CameraModel camera = rolling_camera(lens);
    // The depth identifies one coordinate of the position where it was read; two scenes cover x and y.
    for (const bool across : {false, true}) {
      constexpr double kSlope = 0.003;  // m / px
      const RawScene scene(camera, [&](int x, int y) { return 1 + kSlope * (across ? y : x); });
      for (int trial = 0; trial < 150; ++trial) {
        const Exposure exposure(camera, random_velocity(random), 0.02);
        const DepthSampler sampler = scene.sampler(exposure);
        const Line line = random_line(random);
        DepthStretch stretch(sampler, line.first, line.step, line.count, line.across, 3);
        for (int i = 0; i < line.count; ++i) {
          const Vector2 seen = line.first + i * line.step;
          Vector2 located = seen;
          const bool found = sampler.locate(located, DepthSampler::kUnknown);
          if (!stretch.go_to(i)) continue;
          for (const int side : {-3, 0, 3}) {
            const Vector2 p = located + side * line.across;
            const auto x = static_cast<int>(std::floor(p.x() + 0.5));
            const auto y = static_cast<int>(std::floor(p.y() + 0.5));
            const double depth = sampler.at(x, y);
            if (!found || depth == 0) {
              ++without_depth;
              continue;
            }
            const double got = stretch.at(side);
            if (got == 0) {  // at the border either may be outside
              const Vector2 raw = scene.map.active() ? scene.map.position_px(x, y) : p;
              EXPECT_TRUE(raw.x() < 2 || raw.y() < 2 || raw.x() > kRawWidth - 3 || raw.y() > kRawHeight - 3);
              continue;
            }
            // The exact position, without the rounding to a pixel of the ideal image.
            const Vector2 exact = scene.map.active() ? distort_pixel(camera, p) : p;
            // Beside the border a guess may find no depth, which leaves an error of a pixel or two.
            const bool at_border =
                std::min({exact.x(), exact.y(), kRawWidth - exact.x(), kRawHeight - exact.y()}) < 8;
            EXPECT_NEAR((got - 1) / kSlope, across ? exact.y() : exact.x(), at_border ? 3 : 0.5 + 0.33)
                << trial << " " << i << " " << side;
            EXPECT_NEAR(stretch.at_colour_time(got), sampler.at_colour_time(seen.y(), located, got),
                        5e-4 * got);
            ++read;
          }
        }
      }
    }
  }
  EXPECT_GT(read, 50000);
  EXPECT_GT(without_depth, 1000);
}

// Near and far surfaces alternate. The stretch must read each surface where the depth image shows it, except
// at their borders.
TEST(DepthStretch, FollowsTheSurfaceThatIsSeen) {
  const CameraModel camera = rolling_camera({});
  Vector6 velocity = Vector6::Zero();
  velocity[0] = 1;  // m/s: 8.7 px within 20 ms at 0.6 m, 1.7 px at 3 m
  const Exposure exposure(camera, velocity, 0.02);
  const RawScene scene(camera, [](int x, int) { return x / 40 % 2 == 0 ? 0.6 : 3.0; });
  const DepthSampler sampler = scene.sampler(exposure);
  for (const double row : {60.0, 120.4, 200.0}) {
    DepthStretch stretch(sampler, {20, row}, {3, 0}, 90, {0, 1}, 3);
    int same = 0;
    for (int i = 0; i < 90; ++i) {
      ASSERT_TRUE(stretch.go_to(i));
      Vector2 located(20 + 3 * i, row);
      ASSERT_TRUE(sampler.locate(located, DepthSampler::kUnknown));
      same += stretch.at(0) == sampler.at(static_cast<int>(located.x() + 0.5), static_cast<int>(row + 0.5));
    }
    EXPECT_GT(same, 70) << row;
  }
}

TEST(DepthSampler, LocateWithKnownDepthAgreesWithTheSearch) {
  Random random(11);
  int compared = 0;
  for (const Distortion& lens : kStretchLenses) {
    const RawScene scene(rolling_camera(lens), [](int x, int y) { return 1 + 0.003 * x + 0.001 * y; });
    for (int trial = 0; trial < 300; ++trial) {
      const Exposure exposure(rolling_camera(lens), random_velocity(random), 0.02);
      const DepthSampler sampler = scene.sampler(exposure);
      const Vector2 seen(random.below(kRawWidth), random.below(kRawHeight));
      Vector2 looked_up = seen, known = seen;
      if (!sampler.locate(looked_up, DepthSampler::kUnknown)) continue;
      const double depth =
          sampler.at(static_cast<int>(looked_up.x() + 0.5), static_cast<int>(looked_up.y() + 0.5));
      if (depth == 0) continue;
      if (!sampler.locate(known, sampler.at_colour_time(seen.y(), looked_up, depth))) continue;
      EXPECT_LT((known - looked_up).norm(), 0.3) << seen.transpose();
      ++compared;
    }
  }
  EXPECT_GT(compared, 500);
}

TEST(DepthStretch, ReturnsZeroOutsideTheImage) {
  const CameraModel camera = rolling_camera({});
  const RawScene scene(camera, [](int, int) { return 1.0; });
  const DepthSampler sampler = scene.sampler({});
  DepthStretch stretch(sampler, {-10, 5}, {1, 0}, kRawWidth + 20, {0, 1}, 3);
  for (int i = 0; i < kRawWidth + 20; ++i) {
    ASSERT_TRUE(stretch.go_to(i));
    EXPECT_EQ(stretch.at(0), i >= 10 && i < kRawWidth + 10 ? 1.0 : 0.0) << i;
    EXPECT_EQ(stretch.at(3), i >= 10 && i < kRawWidth + 10 ? 1.0 : 0.0) << i;
  }
  DepthStretch top(sampler, {10, 0}, {1, 0}, 50, {0, 1}, 3);
  ASSERT_TRUE(top.go_to(0));
  EXPECT_EQ(top.at(-3), 0);
  EXPECT_EQ(top.at(0), 1);
}

}  // namespace
}  // namespace plvo
