// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/sensor/inertial_sensor.hpp"

#include <cmath>

#include "plvo/simulator/hash.hpp"

namespace plvo::sim {
namespace {

// Step of the finite differences. The shortest period of the trajectory is 0.15 s, and rounding errors stay
// below 1e-9 m/s².
constexpr double kDifference_s = 5e-4;
constexpr std::uint32_t kGyro = 0x47U, kAccelerometer = 0x41U, kOffset = 0x4fU;

}  // namespace

InertialSensor::InertialSensor(const InertialOptions& options, std::uint64_t seed, bool noise)
    : options_(options), seed_(sensor_seed(seed, 0x49U)), noisy_(noise) {
  if (!noise) return;
  gyro_offset_ = options.gyro_offset_sigma * gaussian_vector(kOffset, kGyro, seed_);
  accelerometer_offset_ =
      options.accelerometer_offset_sigma * gaussian_vector(kOffset, kAccelerometer, seed_);
}

// White noise of this density, sampled at the rate of the sensor.
Vector3 InertialSensor::noise(std::uint32_t sample, std::uint32_t sensor, double density) const {
  if (!noisy_) return Vector3::Zero();
  return density * std::sqrt(options_.rate_hz) * gaussian_vector(sample, sensor, seed_);
}

Vector3 InertialSensor::rate(const Trajectory& trajectory, double t_s, std::uint32_t sample) const {
  const Matrix3 R_before_after =
      trajectory.at(t_s - kDifference_s).R.transpose() * trajectory.at(t_s + kDifference_s).R;
  return rotation_log(R_before_after) / (2 * kDifference_s) + gyro_offset_ +
         noise(sample, kGyro, options_.gyro_noise);
}

Vector3 InertialSensor::force(const Trajectory& trajectory, double t_s, std::uint32_t sample) const {
  const Se3 now = trajectory.at(t_s);
  const Vector3 acceleration =
      (trajectory.at(t_s + kDifference_s).t - 2 * now.t + trajectory.at(t_s - kDifference_s).t) /
      (kDifference_s * kDifference_s);
  return now.R.transpose() * (acceleration + Vector3(0, 0, kStandardGravity)) + accelerometer_offset_ +
         noise(sample, kAccelerometer, options_.accelerometer_noise);
}

}  // namespace plvo::sim
