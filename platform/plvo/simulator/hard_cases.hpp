// SPDX-License-Identifier: Apache-2.0
// Named sequences that are hard for an odometry, for tests and measurements. SimulatedCamera::create makes
// the camera of a case, which delivers the frames and the exact poses.
#pragma once

#include <string>
#include <vector>

#include "plvo/simulator/simulator_options.hpp"

namespace plvo {

struct HardCase {
  std::string name;
  SimulatorOptions options;
};

// "board_still", "board_walks", "person_crosses", "bumper", "dots", "mirror", "comb", "frozen_depth",
// "repeated_frames", "five_hz": about 3.3 s in the corridor at 640×480.
std::vector<HardCase> hard_cases();

}  // namespace plvo
