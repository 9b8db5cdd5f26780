// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/map/closed_sequence.hpp"

#include <memory>

#include "plvo/bench/map/evaluation.hpp"
#include "plvo/simulator/simulated_camera.hpp"

namespace plvo::bench {

ClosedSequence::ClosedSequence(SimulatorOptions options) {
  const int round = options.frames++;  // the last pose is the first one again
  std::unique_ptr<SimulatedCamera> camera;
  need(SimulatedCamera::create(options, camera));
  camera_ = camera->model();
  frame_ns_ = 1e9 / options.fps;
  const auto pixels = static_cast<std::ptrdiff_t>(camera_.width) * camera_.height;
  for (int k = 0; k < round && camera->next(frame_).ok(); ++k) {
    colours_.emplace_back(frame_.colour.data, frame_.colour.data + 3 * pixels);
    depths_.emplace_back(frame_.depth.data, frame_.depth.data + pixels);
    poses_.push_back(camera->pose(k));
  }
}

RgbdFrame ClosedSequence::frame(std::int64_t number) const {
  RgbdFrame frame = frame_;
  frame.colour.data = colours_[place(number)].data();
  frame.depth.data = depths_[place(number)].data();
  frame.stamp_ns = frame.depth_stamp_ns =
      1'000'000'000 + static_cast<std::int64_t>(static_cast<double>(number) * frame_ns_);
  return frame;
}

}  // namespace plvo::bench
