// SPDX-License-Identifier: Apache-2.0
// The depth sensor against its statement: a wall at a known distance, square to the sensor, so that whatever
// is not that distance is noise.
#include <algorithm>
#include <array>
#include <cmath>

#include "plvo/simulator/sensor/kinect_depth.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

using sim::KinectDepth;
using sim::PixelHit;

constexpr int kWidth = 160;
constexpr int kHeight = 120;

// A room of one solid, whose material the tests choose.
struct Stage {
  explicit Stage(const sim::Material& material = {}) {
    scene.solids.resize(1);
    scene.materials.push_back(material);
    camera.width = kWidth;
    camera.height = kHeight;
    camera.pinhole = {525, 525, 79.5, 59.5};
    hits.resize(kWidth * kHeight);
  }
  void wall(double depth_m, float cosine = 0.99F) {
    for (PixelHit& hit : hits) hit = {static_cast<float>(depth_m), cosine, 0};
  }
  ImageView<const PixelHit> view() const { return {hits.data(), kWidth, kHeight, kWidth}; }
  double holes(const DepthSensorOptions& options = {}) const {
    KinectDepth sensor(scene, camera, options, 1, 1);
    sensor.sense(view(), 0);
    int count = 0;
    for (int i = 0; i < kWidth * kHeight; ++i) count += sensor.view().data[i] == 0;
    return count / static_cast<double>(kWidth * kHeight);
  }

  sim::Scene scene;
  CameraModel camera;
  std::vector<PixelHit> hits;
};

// Standard deviation and mean error over some frames. The columns' distances differ by a step of the rounding
// in all, so that every position between two steps has its turn.
std::array<double, 2> spread(Stage& stage, double depth_m, const DepthSensorOptions& options) {
  const double step_m = depth_m * depth_m / (8 * 43.5);
  for (int i = 0; i < kWidth * kHeight; ++i)
    stage.hits[static_cast<std::size_t>(i)] = {
        static_cast<float>(depth_m + step_m * ((i % kWidth) / double{kWidth} - 0.5)), 0.99F, 0};
  KinectDepth sensor(stage.scene, stage.camera, options, 5, 1);
  double sum = 0;
  double squares = 0;
  double count = 0;
  for (std::uint32_t frame = 0; frame < 6; ++frame) {
    sensor.sense(stage.view(), frame);
    const DepthView depth = sensor.view();
    for (std::size_t i = 0; i < stage.hits.size(); ++i) {
      if (depth.data[i] == 0) continue;
      const double d = depth.data[i] * depth.metres_per_unit - static_cast<double>(stage.hits[i].depth_m);
      sum += d;
      squares += d * d;
      ++count;
    }
  }
  const double mean = sum / count;
  return {std::sqrt(squares / count - mean * mean), mean};
}

TEST(KinectDepth, NoiseHasTheStandardDeviationOfTheModelWithAndWithoutRounding) {
  Stage stage;
  DepthSensorOptions options;
  for (const double steps : {0.0, 8.0}) {
    options.steps_per_px = steps;
    for (double z = 0.9; z < 4.4; z += 0.537) {
      const auto [sigma, mean] = spread(stage, z, options);
      EXPECT_NEAR(sigma, 0.55 * options.noise.sigma(z), 0.06 * 0.55 * options.noise.sigma(z))
          << z << " " << steps;
      EXPECT_LT(std::abs(mean), 0.1 * sigma) << z;
    }
  }
}

TEST(KinectDepth, NoiseIsThatOfARealKinect) {
  // Plane residuals measured on freiburg1_rpy.
  constexpr std::array<std::array<double, 2>, 6> kMeasured_m = {
      {{0.85, 0.0015}, {1.45, 0.0037}, {1.8, 0.0055}, {2.25, 0.0078}, {2.75, 0.0125}, {3.25, 0.0148}}};
  Stage stage;
  for (const auto& [z, sigma] : kMeasured_m) {
    EXPECT_NEAR(spread(stage, z, {})[0], sigma, 0.3 * sigma) << z;
  }
}

TEST(KinectDepth, DisparityComesInEighthsOfAPixel) {
  Stage stage;
  stage.wall(2.7);
  KinectDepth sensor(stage.scene, stage.camera, {}, 1, 1);
  sensor.sense(stage.view(), 0);
  const DepthView depth = sensor.view();
  std::vector<int> values;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    if (depth.data[i] == 0) continue;
    const double disparity = 580 * 0.075 / (depth.data[i] * depth.metres_per_unit);
    EXPECT_NEAR(disparity * 8, std::round(disparity * 8), 0.01);
    values.push_back(depth.data[i]);
  }
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  // Steps of z²/(8 f b) = 21 mm; the noise reaches over several.
  ASSERT_GT(values.size(), 3U);
  for (std::size_t k = 1; k < values.size(); ++k)
    EXPECT_NEAR((values[k] - values[k - 1]) * sim::kMetresPerUnit, 2.7 * 2.7 / (8 * 43.5), 0.003);
}

TEST(KinectDepth, ANearThingCastsAShadowBandToItsLeft) {
  Stage stage;
  const double near_m = 1.2;
  const double far_m = 2.4;
  stage.wall(far_m);
  for (int y = 20; y < 100; ++y) {
    for (int x = 80; x < 120; ++x)
      stage.hits[static_cast<std::size_t>(y * kWidth + x)].depth_m = static_cast<float>(near_m);
  }
  KinectDepth sensor(stage.scene, stage.camera, {}, 1, 1);
  sensor.sense(stage.view(), 0);
  // f b (1/z_near − 1/z_far), on the colour camera's pixels.
  const double width_px = 525 * 0.075 * (1 / near_m - 1 / far_m);
  double holes_left = 0;
  double holes_right = 0;
  for (int y = 30; y < 90; ++y) {
    for (int x = 50; x < 80; ++x) holes_left += sensor.view().data[y * kWidth + x] == 0;
    for (int x = 124; x < 154; ++x) holes_right += sensor.view().data[y * kWidth + x] == 0;
  }
  EXPECT_NEAR(holes_left / 60, width_px, 2.0);
  EXPECT_LT(holes_right / 60, 0.5);
}

TEST(KinectDepth, HolesWhereARealOneHasThem) {
  Stage matt;
  matt.wall(2);
  EXPECT_LT(matt.holes(), 0.001);
  matt.wall(0.45);
  EXPECT_EQ(matt.holes(), 1);
  matt.wall(5.2);
  EXPECT_GT(matt.holes(), 0.99);
  DepthSensorOptions farther;
  farther.max_range_m = 8;
  EXPECT_LT(matt.holes(farther), 0.5);
  matt.wall(2, 0.03F);  // grazing
  EXPECT_GT(matt.holes(), 0.99);

  Stage dark({.infrared = 0.03F});
  dark.wall(3);
  EXPECT_GT(dark.holes(), 0.9);
  dark.wall(0.8);
  EXPECT_LT(dark.holes(), 0.1);

  Stage glossy({.gloss = 0.95F, .infrared = 0.3F});
  glossy.wall(3, 0.35F);
  EXPECT_GT(glossy.holes(), 0.8);
  glossy.wall(1, 0.9995F);  // the mirror image of the projector
  EXPECT_GT(glossy.holes(), 0.9);
}

TEST(KinectDepth, TheTwinIsExactToHalfAUnit) {
  SimulatorOptions options = test::small_options(SceneName::kBare);
  options.noise = false;
  for (const test::Shot& shot : test::shoot(options)) {
    for (std::size_t i = 0; i < shot.exact.size(); ++i)
      ASSERT_NEAR(shot.depth[i] * sim::kMetresPerUnit, static_cast<double>(shot.exact[i]), 0.000101);
  }
}

}  // namespace
}  // namespace plvo
