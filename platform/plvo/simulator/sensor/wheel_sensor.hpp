// SPDX-License-Identifier: Apache-2.0
// The wheel odometry of the robot that carries the simulated camera. Its base can drive in every direction
// (mecanum wheels). A sample is the derivative of the base's path, times what the wheels get wrong: a
// constant error of their size and of their distance, slip of one side for half a second, and white noise.
#pragma once

#include <cstdint>

#include "plvo/simulator/motion/trajectory.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::sim {

class WheelSensor {
 public:
  // noise == false: exact samples.
  WheelSensor(const SimulatedWheels& options, std::uint64_t seed, bool noise);

  // vx vy wz of the base at t_s of the trajectory. sample: its index, which determines its noise.
  Vector3 velocity(const Trajectory& trajectory, double t_s, std::uint32_t sample) const;

 private:
  SimulatedWheels options_;
  std::uint32_t seed_;
  bool noisy_;
  double speed_scale_ = 1, turn_scale_ = 1;
};

}  // namespace plvo::sim
