// SPDX-License-Identifier: Apache-2.0
// A small simulated camera and copies of its frames, which outlive the camera's own buffers.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "plvo/simulator/simulated_camera.hpp"

namespace plvo::test {

inline SimulatorOptions small_options(SceneName scene, LightName light = LightName::kConstant) {
  SimulatorOptions options;
  options.scene = scene;
  options.light = light;
  options.frames = 4;
  options.camera.width = 160;
  options.camera.height = 120;
  options.camera.pinhole = {131.25, 131.25, 79.5, 59.5};
  return options;
}

struct Shot {
  std::int64_t stamp_ns = 0;
  Se3 T_world_camera;
  std::vector<std::uint8_t> colour;
  std::vector<std::uint16_t> depth;
  std::vector<float> exact;

  double gray(std::size_t pixel) const {
    return 0.299 * colour[3 * pixel] + 0.587 * colour[3 * pixel + 1] + 0.114 * colour[3 * pixel + 2];
  }
};

inline std::vector<Shot> shoot(const SimulatorOptions& options) {
  std::unique_ptr<SimulatedCamera> camera;
  const Status status = SimulatedCamera::create(options, camera);
  EXPECT_TRUE(status.ok()) << status.message();
  std::vector<Shot> shots;
  RgbdFrame frame;
  while (status.ok() && camera->next(frame).ok()) {
    const std::size_t pixels =
        static_cast<std::size_t>(frame.colour.width) * static_cast<std::size_t>(frame.colour.height);
    const ImageView<const float> exact = camera->exact_depth();
    Shot shot;
    shot.stamp_ns = frame.stamp_ns;
    shot.T_world_camera = camera->ground_truth(frame.stamp_ns);
    shot.colour.assign(frame.colour.data, frame.colour.data + 3 * pixels);
    shot.depth.assign(frame.depth.data, frame.depth.data + pixels);
    shot.exact.assign(exact.data, exact.data + pixels);
    shots.push_back(std::move(shot));
  }
  return shots;
}

}  // namespace plvo::test
