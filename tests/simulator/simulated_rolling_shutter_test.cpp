// SPDX-License-Identifier: Apache-2.0
// Row by row, a rolling shutter sees what a global one sees from where the camera stood when that row was
// exposed.
#include <algorithm>

#include "plvo/simulator/motion/trajectory.hpp"
#include "plvo/simulator/render/ray_caster.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

using test::shoot;
using test::Shot;
using test::small_options;

TEST(SimulatedRollingShutter, EachRowIsSeenFromItsOwnPose) {
  SimulatorOptions options = small_options(SceneName::kHall);
  options.noise = false;
  options.frames = 3;
  options.camera.readout_s = 0.03;
  const std::vector<Shot> rolled = shoot(options);
  ASSERT_EQ(rolled.size(), 3U);
  std::unique_ptr<SimulatedCamera> camera;
  ASSERT_TRUE(SimulatedCamera::create(options, camera).ok());

  const std::unique_ptr<sim::Scene> scene = sim::build_scene(options.scene, options.seed);
  CameraModel global = options.camera;
  global.readout_s = 0;
  sim::RayCaster caster(*scene, global, 1);
  const int height = options.camera.height;
  const int width = options.camera.width;
  std::size_t moved = 0;
  for (int row : {0, 17, height / 2, height - 1}) {
    const double delay_s = options.camera.readout_s * (row / (height - 1.0) - 0.5);
    const Se3 T = camera->ground_truth(rolled[1].stamp_ns + static_cast<std::int64_t>(delay_s * 1e9));
    const auto exact_of = [&](const Se3& pose) {
      caster.cast(std::vector<Se3>(static_cast<std::size_t>(height), pose));
      std::vector<float> depths;
      for (int x = 0; x < width; ++x) depths.push_back(caster.hits().data[row * width + x].depth_m);
      return depths;
    };
    const std::vector<float> expected = exact_of(T);
    const std::vector<float> middle = exact_of(rolled[1].T_world_camera);
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(row * width + x);
      // Stamps are whole nanoseconds: a ray in a thousand may pass an edge on the other side.
      EXPECT_NEAR(rolled[1].exact[i], expected[static_cast<std::size_t>(x)], 1e-3F) << row << ' ' << x;
      moved += std::abs(expected[static_cast<std::size_t>(x)] - middle[static_cast<std::size_t>(x)]) > 1e-3F
                   ? 1U
                   : 0U;
    }
  }
  EXPECT_GT(moved, static_cast<std::size_t>(width))
      << "the shutter must matter for the test to mean something";
}

}  // namespace
}  // namespace plvo
