// SPDX-License-Identifier: Apache-2.0
// The images of a closed trajectory, rendered once and repeated for many rounds: rendering takes longer than
// tracking.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/image/frame.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::bench {

class ClosedSequence {
 public:
  // options.frames: the frames of one round.
  explicit ClosedSequence(SimulatorOptions options);

  int frames() const { return static_cast<int>(poses_.size()); }
  const CameraModel& camera() const { return camera_; }
  // Frame `number` of a sequence of many rounds.
  RgbdFrame frame(std::int64_t number) const;
  const Se3& pose(std::int64_t number) const { return poses_[place(number)]; }

 private:
  std::size_t place(std::int64_t number) const { return static_cast<std::size_t>(number) % poses_.size(); }

  CameraModel camera_;
  double frame_ns_ = 0;
  RgbdFrame frame_;
  std::vector<Se3> poses_;
  std::vector<std::vector<std::uint8_t>> colours_;
  std::vector<std::vector<std::uint16_t>> depths_;
};

}  // namespace plvo::bench
