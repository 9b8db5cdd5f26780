// SPDX-License-Identifier: Apache-2.0
// A gyro and an accelerometer that move with the simulated camera and share its axes. A sample is the
// derivative of the trajectory plus a constant offset and white noise. The noise depends on the sample number
// only.
#pragma once

#include <cstdint>

#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/simulator/motion/trajectory.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::sim {

class InertialSensor {
 public:
  // noise == false: exact samples.
  InertialSensor(const InertialOptions& options, std::uint64_t seed, bool noise);

  // Angular velocity in rad/s and specific force in m/s² (9.8 upwards at rest) at t_s of the trajectory. The
  // caller sets the stamps. sample: index of the sample, which determines its noise.
  Vector3 rate(const Trajectory& trajectory, double t_s, std::uint32_t sample) const;
  Vector3 force(const Trajectory& trajectory, double t_s, std::uint32_t sample) const;

 private:
  Vector3 noise(std::uint32_t sample, std::uint32_t sensor, double density) const;

  InertialOptions options_;
  std::uint32_t seed_;
  bool noisy_;
  Vector3 gyro_offset_ = Vector3::Zero(), accelerometer_offset_ = Vector3::Zero();
};

}  // namespace plvo::sim
