// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/sensor/wheel_sensor.hpp"

#include <cmath>

#include "plvo/simulator/hash.hpp"

namespace plvo::sim {
namespace {

constexpr double kWheelDifference_s = 2e-3;  // of the finite differences
constexpr double kSlip_s = 0.5;
constexpr std::uint32_t kWheelScale = 0x53U, kWheelSlip = 0x50U, kWheelNoise = 0x4eU;

}  // namespace

WheelSensor::WheelSensor(const SimulatedWheels& options, std::uint64_t seed, bool noise)
    : options_(options), seed_(sensor_seed(seed, 0x57U)), noisy_(noise) {
  if (!noise) return;
  speed_scale_ += options.speed_scale_sigma * static_cast<double>(gaussian(hash(kWheelScale, 0, seed_)));
  turn_scale_ += options.turn_scale_sigma * static_cast<double>(gaussian(hash(kWheelScale, 1, seed_)));
}

Vector3 WheelSensor::velocity(const Trajectory& trajectory, double t_s, std::uint32_t sample) const {
  const Se3 T_camera_base = robot_camera().inverse();
  const Se3 T_before_after = (trajectory.at(t_s - kWheelDifference_s) * T_camera_base).inverse() *
                             trajectory.at(t_s + kWheelDifference_s) * T_camera_base;
  const Vector3 turn = rotation_log(T_before_after.R);
  // In the axes at t_s, half of the turn after those of T_before_after.
  const Vector3 way = rotation_exp(-0.5 * turn) * T_before_after.t;
  Vector3 v(way.x(), way.y(), turn.z());
  v /= 2 * kWheelDifference_s;
  if (!noisy_) return v;
  v.head<2>() *= speed_scale_;
  v.z() *= turn_scale_;
  const auto window = static_cast<std::uint32_t>(std::floor(t_s / kSlip_s) + 1000);
  const std::uint32_t draw = hash(kWheelSlip, window, seed_);
  if (static_cast<double>(uniform(draw)) < options_.slip_share) {
    // The wheels of one side turn more than the base moves.
    const double side = (hash(draw) & 1U) != 0U ? 1 : -1;
    const double more_mps = options_.slip * v.x();
    v.x() += 0.5 * more_mps;
    v.z() += side * more_mps / options_.track_m;
  }
  const Vector3 sigma(options_.noise_mps, options_.noise_mps, options_.noise_rps);
  v += sigma.cwiseProduct(gaussian_vector(kWheelNoise, sample, seed_));
  return v;
}

}  // namespace plvo::sim
