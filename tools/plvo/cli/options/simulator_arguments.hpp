// SPDX-License-Identifier: Apache-2.0
// The simulated camera's options on the command line, shared by `plvo simulate` and `plvo run --camera sim`.
#pragma once

#include <cstdint>
#include <string>

#include "plvo/cli/options/arguments.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::cli {

inline constexpr const char* kSimulatorGroup = "Simulated camera";
inline constexpr int kSimulatedFrames = 180;  // unless told otherwise: 6 s
inline constexpr int kMostSimulatedFrames = 1'000'000;

struct SimulatorArguments {
  SceneName scene = SceneName::kCorridor;
  LightName light = LightName::kConstant;
  std::uint64_t seed = 1;
  std::uint32_t storey = 0;
  double fps = 30;
  double readout_s = 0;
  int width = 0, height = 0;  // 0: the simulator's own size
  DepthSchedule depth_schedule;
  double depth_scale_error = 1;
  int covered_first = 0, covered_end = 0;
  Difficulties difficulties;
  bool still = false;
  bool robot = false;
  std::string trajectory;
  bool clean = false;
  int threads = 2;
};
void add_simulator_options(CLI::App& command, SimulatorArguments& arguments);

// kInvalidArgument, naming the option. `frames` is how many there shall be.
Status make_simulator_options(const SimulatorArguments& arguments, int frames, SimulatorOptions& options);

}  // namespace plvo::cli
