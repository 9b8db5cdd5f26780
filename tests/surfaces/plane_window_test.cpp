// SPDX-License-Identifier: Apache-2.0
// Fits a plane to a window of depth. The tests compare its position and normal with the rendered plane,
// compare its variances with the spread under noise, and check that windows without a plane are rejected.
#include "plvo/surfaces/plane_window.hpp"

#include <gtest/gtest.h>

#include "depth_holes.hpp"
#include "depth_picture.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::depth_of_plane;
using test::DepthPicture;
using test::Gaussian;

constexpr int kWidth = 96;
constexpr int kHeight = 72;
constexpr Pinhole kPinhole{90, 92, 47.5, 35.5};
// The resolution of a Kinect-like image, where noise limits the accuracy of the normal.
constexpr Pinhole kFine{525, 525, 47.5, 35.5};

struct Wall {
  Vector3 n;  // unit, towards the camera: n · X = −d
  double d;
};

DepthPicture picture_of(const Wall& wall, const Pinhole& pinhole = kPinhole) {
  return {kWidth, kHeight, [&](int x, int y) { return depth_of_plane(pinhole, x, y, wall.n, -wall.d); }};
}

TEST(PlaneWindow, RecoversTheRenderedPlane) {
  for (const Wall& wall : {Wall{{0, 0, -1}, 2.0}, Wall{Vector3(0.5, 0.1, -0.8).normalized(), 1.7},
                           Wall{Vector3(-0.2, 0.7, -0.5).normalized(), 1.1}}) {
    const DepthPicture picture = picture_of(wall);
    int found = 0;
    for (double v = 12; v < kHeight - 12; v += 5.3)
      for (double u = 12; u < kWidth - 12; u += 4.7) {
        SurfaceSample sample;
        if (!observe_surface(picture.sampler(), kPinhole, u, v, 1, sample)) continue;
        ++found;
        const Vector2 pixel = project(kPinhole, sample.p);
        EXPECT_NEAR(pixel.x(), u, 1e-9);
        EXPECT_NEAR(pixel.y(), v, 1e-9);
        EXPECT_NEAR(wall.n.dot(sample.p), -wall.d, 2 * DepthPicture::kUnit);
        EXPECT_GT(wall.n.dot(sample.normal), 0.9999);
        // A depth error moves a slanted surface less along its normal than along the ray.
        const double sigma_d = DepthNoise{}.sigma(sample.p.z());
        const double cosine = -wall.n.dot(sample.p) / sample.p.z();
        EXPECT_NEAR(sample.variance, cosine * cosine * sigma_d * sigma_d, 0.01 * sample.variance);
      }
    EXPECT_GT(found, 60);
  }
}

// A missing reading must be missing from every sum.
TEST(PlaneWindow, IsUnbiasedByMissingReadings) {
  const Wall wall{Vector3(0.5, 0.1, -0.8).normalized(), 1.7};
  constexpr int kU = 48, kV = 36;
  // The readings are three pixels apart. Missing are the first, the last of a row, the middle one and a
  // corner.
  const auto hole = [](int x, int y) {
    const int i = (x - kU) / 3, j = (y - kV) / 3;
    return (i == -3 && j == -3) || (i == 3 && j == -1) || (i == 0 && j == 0) || (i == 3 && j == 3);
  };
  const DepthPicture picture(kWidth, kHeight, [&](int x, int y) {
    return hole(x, y) ? 0.0 : depth_of_plane(kPinhole, x, y, wall.n, -wall.d);
  });
  SurfaceSample whole, holed;
  ASSERT_TRUE(observe_surface(picture_of(wall).sampler(), kPinhole, kU, kV, 1, whole));
  ASSERT_TRUE(observe_surface(picture.sampler(), kPinhole, kU, kV, 1, holed));
  EXPECT_NEAR(wall.n.dot(holed.p), -wall.d, 2 * DepthPicture::kUnit);
  EXPECT_GT(wall.n.dot(holed.normal), 0.9999);
  EXPECT_GT(holed.normal_variance, whole.normal_variance) << "it is known less well";
}

// Readings from beside a hole count where they were read, so a slope does not bias the plane.
TEST(PlaneWindow, RecoversThePlaneThroughHoles) {
  const Wall wall{Vector3(0.5, 0.1, -0.8).normalized(), 1.7};
  for (const test::HolePattern& pattern : test::kHolePatterns) {
    const DepthPicture picture(kWidth, kHeight, [&](int x, int y) {
      return pattern.missing(x, y) ? 0.0 : depth_of_plane(kPinhole, x, y, wall.n, -wall.d);
    });
    int found = 0, asked = 0;
    for (int v = 12; v < kHeight - 12; v += 3)
      for (int u = 12; u < kWidth - 12; u += 4) {
        ++asked;
        SurfaceSample sample;
        if (!observe_surface(picture.sampler(), kPinhole, u, v, 1, sample)) continue;
        ++found;
        EXPECT_NEAR(wall.n.dot(sample.p), -wall.d, 2 * DepthPicture::kUnit) << pattern.name;
        EXPECT_GT(wall.n.dot(sample.normal), 0.9999) << pattern.name;
      }
    EXPECT_GT(found, 0.95 * asked) << pattern.name;
  }
}

TEST(PlaneWindow, VarianceOfTheNormalMatchesItsSpread) {
  Gaussian gaussian(7);
  const Wall wall{Vector3(0.4, -0.2, -0.9).normalized(), 2};
  constexpr double kShare = 0.5;  // share of σ_d
  double spread = 0;
  double stated = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    const DepthPicture picture(32, 32, [&](int x, int y) {
      const double z = depth_of_plane(kFine, x, y, wall.n, -wall.d);
      return z + kShare * DepthNoise{}.sigma(z) * gaussian();
    });
    SurfaceSample sample;
    ASSERT_TRUE(observe_surface(picture.sampler(), kFine, 16, 16, kShare * kShare, sample));
    // There are two directions across the normal, so half of the squared distance is the variance of one.
    spread += 0.5 * (sample.normal - wall.n).squaredNorm() / kTrials;
    stated += sample.normal_variance / kTrials;
  }
  // The stated variance is that of a surface that faces the camera. On a slope the true variance is smaller
  // in one of the two directions.
  EXPECT_GT(stated, 0.9 * spread);
  EXPECT_LT(stated, 1.5 * spread);
}

TEST(PlaneWindow, RejectsEdgesHolesAndGrazingSurfaces) {
  SurfaceSample sample;
  const auto seen = [&](const DepthPicture& picture) {
    return observe_surface(picture.sampler(), kPinhole, 48, 36, 1, sample);
  };
  EXPECT_TRUE(seen({kWidth, kHeight, [](int, int) { return 1.5; }}));
  EXPECT_FALSE(seen({kWidth, kHeight, [](int x, int) { return x < 50 ? 1.5 : 1.7; }}));
  EXPECT_FALSE(seen({kWidth, kHeight, [](int x, int) { return x < 47 ? 1.5 : 0.0; }}));
  EXPECT_TRUE(seen({kWidth, kHeight, [](int x, int y) { return x == 48 && y == 36 ? 0.0 : 1.5; }}));
  EXPECT_FALSE(seen(picture_of({Vector3(0, -0.995, -0.09).normalized(), 0.2})));
  EXPECT_FALSE(observe_surface(DepthPicture(kWidth, kHeight, [](int, int) { return 1.5; }).sampler(),
                               kPinhole, kWidth + 3.0, 36, 1, sample))
      << "beside the image";
}

// A wall approaches. Depth is exposed 20 ms before colour, so the depth image shows the wall farther away.
TEST(PlaneWindow, MovesFromTheTimeOfDepthToThatOfColour) {
  CameraModel camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.pinhole = kPinhole;
  camera.depth_timing = {.known = true, .delay_s = -0.02, .readout_s = 0};
  Vector6 velocity = Vector6::Zero();
  velocity[2] = -0.5;
  const Exposure exposure(camera, velocity, -0.02);
  const DepthPicture picture(kWidth, kHeight, [](int, int) { return 1.51; });
  for (const double expected_m : {DepthSampler::kUnknown, 1.5}) {
    SurfaceSample sample;
    double depth_row = -1;
    ASSERT_TRUE(
        observe_surface(picture.sampler(exposure), kPinhole, 60, 20, 1, sample, expected_m, &depth_row));
    EXPECT_NEAR(sample.p.z(), 1.5, 2 * DepthPicture::kUnit);
    EXPECT_NEAR(depth_row, 20, 0.5);
  }
}

}  // namespace
}  // namespace plvo
