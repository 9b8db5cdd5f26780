// SPDX-License-Identifier: Apache-2.0
// A gyro and an accelerometer that move with the simulated camera, in its axes: what the walk's derivatives
// say, a constant offset and white noise. The samples depend on their number alone.
#pragma once

#include <cstdint>

#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/simulator/motion/trajectory.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::sim {

class InertialSensor {
 public:
  // noise false: the exact twin.
  InertialSensor(const InertialOptions& options, std::uint64_t seed, bool noise);

  // Angular velocity in rad/s and specific force in m/s² (9.8 upwards at rest) at t_s of the walk; stamps are
  // the caller's. sample: which one of the sensor's, for its noise.
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
