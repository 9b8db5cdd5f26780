// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/depth_sampler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "depth_holes.hpp"
#include "plvo/base/arena.hpp"
#include "plvo/base/random.hpp"

namespace plvo {
namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 36;
constexpr int kReach = 2;       // px: windows of 5 × 5
constexpr double kUnit = 5e-5;  // m: fine steps, so that the sampler's own errors dominate

// A depth image computed by a function of the pixel, in metres, without a lens.
struct Scene {
  template <typename Function>
  explicit Scene(Function depth_m) : units(kWidth * kHeight) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        units[static_cast<std::size_t>(y * kWidth + x)] =
            static_cast<std::uint16_t>(std::floor(depth_m(x, y) / kUnit + 0.5));
  }
  DepthSampler sampler(double registration_px = 0) const {
    DepthNoise noise;
    noise.registration_px = registration_px;
    return {{units.data(), kWidth, kHeight, kWidth, kUnit}, map, noise};
  }
  std::vector<std::uint16_t> units;
  UndistortionMap map;
};

// A plane of the world is a plane in inverse depth: q = q0 + qx x + qy y.
struct Plane {
  double q0, qx, qy;
  double operator()(double x, double y) const { return 1 / (q0 + qx * x + qy * y); }
};

TEST(DepthSampler, RecoversASlantedPlaneBetweenThePixels) {
  for (const Plane& plane : {Plane{0.8, 0, 0}, Plane{0.7, 0.002, 0}, Plane{0.9, -0.001, 0.0015}}) {
    const Scene scene(plane);
    const DepthSampler sampler = scene.sampler();
    for (double v = 3; v < kHeight - 3; v += 3.37)
      for (double u = 3; u < kWidth - 3; u += 4.19)
        for (int radius : {1, 2, 3}) {
          const DepthSample sample = sampler.sample(u, v, radius);
          ASSERT_NEAR(sample.depth_m, plane(u, v), kUnit) << u << " " << v;
          ASSERT_FALSE(sample.on_edge);
          ASSERT_NEAR(sample.sigma_m, sampler.noise().sigma(plane(u, v)), 1e-6);
        }
  }
}

TEST(DepthSampler, ASlopeWidensSigmaByTheRegistration) {
  const Plane plane{0.7, 0.002, 0.001};
  const Scene scene(plane);
  const double u = 20.3, v = 17.8;
  const double z = plane(u, v);
  const double slope = z * z * std::sqrt(plane.qx * plane.qx + plane.qy * plane.qy);  // m / px
  for (double registration : {0.5, 2.0}) {
    const DepthSampler sampler = scene.sampler(registration);
    const double expected = std::hypot(sampler.noise().sigma(z), registration * slope);
    EXPECT_NEAR(sampler.sample(u, v, kReach).sigma_m, expected, 0.02 * expected);
    EXPECT_GT(sampler.sample(u, v, kReach).sigma_m, sampler.noise().sigma(z));
  }
  const Scene flat([](int, int) { return 1.4; });
  EXPECT_NEAR(flat.sampler(2).sample(u, v, kReach).sigma_m, DepthNoise{}.sigma(1.4), 1e-6);
}

TEST(DepthSampler, OnAnEdgeTheNearerSurfaceCounts) {
  // The nearer surface ends with column 23.
  const Scene scene([](int x, int) { return x <= 23 ? 1.0 : 1.5; });
  const DepthSampler sampler = scene.sampler();
  for (double u : {22.0, 23.0, 23.4, 24.0, 25.0}) {
    const DepthSample sample = sampler.sample(u, 18, kReach);
    EXPECT_NEAR(sample.depth_m, 1.0, 1e-9) << u;
    EXPECT_TRUE(sample.on_edge) << u;
    EXPECT_NEAR(sample.sigma_m, 2 * sampler.noise().sigma(1.0), 1e-9) << u;
  }
  EXPECT_NEAR(sampler.sample(21, 18, kReach).depth_m, 1.0, 1e-9);
  EXPECT_FALSE(sampler.sample(21, 18, kReach).on_edge);
  EXPECT_NEAR(sampler.sample(26, 18, kReach).depth_m, 1.5, 1e-9);
  EXPECT_FALSE(sampler.sample(26, 18, kReach).on_edge);
}

TEST(DepthSampler, IgnoresOneOrTwoFlyingPixels) {
  for (const int flying : {1, 2}) {
    Scene scene([](int, int) { return 1.5; });
    for (int i = 0; i < flying; ++i) scene.units[static_cast<std::size_t>(18 * kWidth + 22 + i)] /= 2;
    const DepthSample sample = scene.sampler().sample(23, 18, kReach);
    EXPECT_NEAR(sample.depth_m, 1.5, 1e-9) << flying;
  }
  // Three pixels count as a surface.
  Scene thin([](int, int) { return 1.5; });
  for (int i = 0; i < 3; ++i) thin.units[static_cast<std::size_t>(18 * kWidth + 22 + i)] /= 2;
  EXPECT_NEAR(thin.sampler().sample(23, 18, kReach).depth_m, 0.75, 1e-3);
}

TEST(DepthSampler, DepthExposedApartIsReadWhereTheSurfaceWas) {
  // A camera that turns at 1 rad/s sees the border of the nearer surface elsewhere when depth is exposed.
  const Scene scene([](int x, int) { return x <= 23 ? 1.0 : 1.5; });
  CameraModel camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.pinhole = {500, 500, 20, 18};
  camera.depth_timing = {true, 0, 0};
  Vector6 velocity = Vector6::Zero();
  velocity[4] = 1;  // dX/dt = ω × X: the scene moves to larger u
  const double shift_px = 500 * 0.01;
  const DepthSampler at_rest = scene.sampler();
  const DepthSampler turning = at_rest.with(Exposure(camera, velocity, 0.01));
  for (const double u : {14.0, 16.0, 22.0, 26.0})
    EXPECT_NEAR(turning.sample(u, 18, kReach).depth_m, at_rest.sample(u + shift_px, 18, kReach).depth_m, 0.01)
        << u;
  EXPECT_NEAR(turning.sample(22, 18, kReach).depth_m, 1.5, 0.01);
  EXPECT_NEAR(at_rest.sample(22, 18, kReach).depth_m, 1.0, 0.01);
}

TEST(DepthSampler, MarksAnEdgeOnlyAboveTheStepThreshold) {
  // An edge is a step of more than six sigma and more than 4 % of the depth.
  const auto step = [](double jump_m) {
    return Scene([=](int x, int) { return x <= 23 ? 1.0 : 1.0 + jump_m; });
  };
  EXPECT_FALSE(step(0.039).sampler().sample(23, 18, kReach).on_edge);
  EXPECT_TRUE(step(0.041).sampler().sample(23, 18, kReach).on_edge);
}

TEST(DepthSampler, AHalfEmptyWindowHasDepthOnlyAmongReadings) {
  // The first `count` columns of the 5×5 window around (20, 15), and all columns before them, are empty.
  const auto seen = [](int columns) {
    return Scene([=](int x, int) { return x < 18 + columns ? 0.0 : 1.2; }).sampler().sample(20, 15, kReach);
  };
  EXPECT_NEAR(seen(2).depth_m, 1.2, 1e-9) << "15 of 25 are left";
  EXPECT_EQ(seen(3).depth_m, 0) << "10 of 25 are left, all on one side";
  EXPECT_EQ(seen(3).sigma_m, 0);
  // The same number of empty columns, but with readings on both sides.
  const Scene gap([](int x, int) { return x >= 19 && x < 22 ? 0.0 : 1.2; });
  EXPECT_NEAR(gap.sampler().sample(20, 15, kReach).depth_m, 1.2, 1e-9);
  EXPECT_EQ(gap.sampler().sample(20, 15, 0).depth_m, 0) << "a single reading";
  const Scene empty([](int, int) { return 0.0; });
  EXPECT_EQ(empty.sampler().sample(20, 15, kReach).depth_m, 0);
}

TEST(DepthSampler, RecoversAPlaneThroughHoles) {
  const Plane plane{0.7, 0.002, 0.001};
  for (const test::HolePattern& pattern : test::kHolePatterns) {
    const Scene scene([&](int x, int y) { return pattern.missing(x, y) ? 0.0 : plane(x, y); });
    const DepthSampler sampler = scene.sampler();
    int found = 0, asked = 0;
    for (double v = 4; v < kHeight - 4; v += 1.37)
      for (double u = 4; u < kWidth - 4; u += 1.19) {
        ++asked;
        const DepthSample sample = sampler.sample(u, v, kReach);
        const double near_m = sampler.near(static_cast<int>(u), static_cast<int>(v));
        if (near_m > 0) {
          ASSERT_NEAR(near_m, plane(static_cast<int>(u), static_cast<int>(v)), 2 * kUnit);
        }
        if (!(sample.depth_m > 0)) continue;
        ++found;
        ASSERT_NEAR(sample.depth_m, plane(u, v), 2 * kUnit) << pattern.name << " " << u << " " << v;
        ASSERT_FALSE(sample.on_edge);
      }
    EXPECT_GT(found, 0.97 * asked) << pattern.name;
  }
}

// A hole between two surfaces has no depth: neither of them surrounds it.
TEST(DepthSampler, AShadowHasNoDepth) {
  const Scene scene([](int x, int) { return x <= 20 ? 1.0 : x <= 25 ? 0.0 : 1.5; });
  const DepthSampler sampler = scene.sampler();
  for (int x = 21; x <= 25; ++x) EXPECT_EQ(sampler.near(x, 18), 0) << x;
  EXPECT_NEAR(sampler.near(20, 18), 1.0, 1e-9);
  EXPECT_NEAR(sampler.near(26, 18), 1.5, 1e-9);
  EXPECT_EQ(sampler.near(-1, 18), 0);
  EXPECT_EQ(sampler.near(18, kHeight), 0);
}

TEST(DepthSampler, ClipsTheWindowAtTheBorder) {
  const Plane plane{0.7, 0.001, 0.0007};
  const Scene scene(plane);
  const DepthSampler sampler = scene.sampler();
  EXPECT_EQ(sampler.sample(0, 0, kReach).depth_m, 0) << "a corner holds 9 of 25 pixels";
  const double right = kWidth - 1;
  const double bottom = kHeight - 1;
  EXPECT_EQ(sampler.sample(right, bottom, kReach).depth_m, 0);
  for (double x : {0.0, right}) EXPECT_NEAR(sampler.sample(x, 18, kReach).depth_m, plane(x, 18), kUnit);
  for (double y : {0.0, bottom}) EXPECT_NEAR(sampler.sample(20, y, kReach).depth_m, plane(20, y), kUnit);
  EXPECT_EQ(sampler.at(-1, 5), 0);
  EXPECT_EQ(sampler.at(5, -1), 0);
  EXPECT_EQ(sampler.at(kWidth, 5), 0);
  EXPECT_EQ(sampler.at(5, kHeight), 0);
}

TEST(DepthSampler, LimitsTheRadiusToThree) {
  const Scene scene([](int x, int) { return x <= 23 ? 1.0 : 1.5; });
  EXPECT_TRUE(scene.sampler().sample(26, 18, 3).on_edge);
  EXPECT_FALSE(scene.sampler().sample(27, 18, 3).on_edge);
  EXPECT_FALSE(scene.sampler().sample(27, 18, 100).on_edge);
}

// A slope seen through a lens; its depth identifies the raw pixel.
struct SlopeBehind {
  explicit SlopeBehind(const Distortion& lens)
      : scene([](int x, int y) { return 0.5 + 0.01 * x + 0.02 * y; }),
        memory(kWidth * kHeight * 4 + 2 * kArenaAlignment),
        arena(memory) {
    scene.map.allocate(arena, kWidth, kHeight);
    scene.map.init({kWidth, kHeight, {40, 40, 24, 18}, lens});
  }
  Scene scene;

 private:
  std::vector<std::byte> memory;
  Arena arena;
};
const Distortion kLens{0.1, 0.02, 0.001, 0, 0};

TEST(DepthSampler, ReadsThroughTheLens) {
  const SlopeBehind slope(kLens);
  const Scene& scene = slope.scene;
  const DepthSampler sampler = scene.sampler();
  int outside = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      int raw_x = 0, raw_y = 0;
      if (!scene.map.raw_pixel(x, y, raw_x, raw_y)) {
        ++outside;
        ASSERT_EQ(sampler.at(x, y), 0);
        continue;
      }
      ASSERT_NEAR(sampler.at(x, y), 0.5 + 0.01 * raw_x + 0.02 * raw_y, kUnit);
    }
  EXPECT_GT(outside, 0);
}

// The sampler sums whole windows of one surface with SIMD vectors and all other windows reading by reading. A
// copy of the image that is cut off beside the window forces the same window onto the second path.
TEST(DepthSampler, SimdWindowsEqualWindowsReadOneByOne) {
  Random random(11);
  const auto scene_of = [&](double noise_m, int gap) {
    return Scene([&, noise_m, gap](int x, int y) {
      if (gap > 0 && random.below(static_cast<std::uint32_t>(gap)) == 0) return 0.0;
      return (x + y / 2 < 40 ? 1.0 : 1.3) + 0.004 * x - 0.003 * y + noise_m * random.uniform();
    });
  };
  int same = 0;
  int on_edge = 0;
  for (const auto& [noise_m, gap] : {std::pair(0.0, 0), std::pair(0.02, 0), std::pair(0.005, 20)}) {
    const Scene scene = scene_of(noise_m, gap);
    const DepthSampler whole = scene.sampler(0.5);
    for (int y = 3; y < kHeight - 3; ++y)
      for (int x = 3; x < kWidth - 8; ++x)
        for (const int radius : {0, 1, 2, 3}) {
          DepthNoise noise;
          noise.registration_px = 0.5;
          const DepthSampler cut({scene.units.data(), x + radius + 1, kHeight, kWidth, kUnit}, scene.map,
                                 noise);
          const double u = x + 0.9 * random.uniform() - 0.45;
          const double v = y + 0.9 * random.uniform() - 0.45;
          const DepthSample a = whole.sample(u, v, radius);
          const DepthSample b = cut.sample(u, v, radius);
          ASSERT_EQ(a.depth_m, b.depth_m) << x << " " << y << " " << radius;
          ASSERT_EQ(a.sigma_m, b.sigma_m);
          ASSERT_EQ(a.on_edge, b.on_edge);
          on_edge += a.on_edge ? 1 : 0;
          ++same;
        }
  }
  EXPECT_GT(on_edge, 500);
  EXPECT_GT(same, 10000);
}

// The sampler recovers a plane of the world at positions between the pixels, through a lens.
TEST(DepthSampler, RecoversAPlaneThroughTheLens) {
  const CameraModel camera{kWidth, kHeight, {40, 40, 24, 18}, kLens};
  const Plane plane{0.8, 0.003, -0.002};
  Scene scene([&](int x, int y) {
    const Vector2 p = undistort_pixel(camera, Vector2(x, y));
    return plane(p.x(), p.y());
  });
  std::vector<std::byte> memory(kWidth * kHeight * 4 + 2 * kArenaAlignment);
  Arena arena(memory);
  scene.map.allocate(arena, kWidth, kHeight);
  scene.map.init(camera);
  for (double v = 5; v < kHeight - 5; v += 3.37)
    for (double u = 5; u < kWidth - 5; u += 4.19) {
      const double depth_m = scene.sampler().sample(u, v, kReach).depth_m;
      ASSERT_NEAR(depth_m, plane(u, v), 5e-4) << u << " " << v;
    }
}

}  // namespace
}  // namespace plvo
