// SPDX-License-Identifier: Apache-2.0
#include "plvo/inertial/imu_config.hpp"

namespace plvo {
namespace {

Status refuse_entry(const char* entry, const char* range) {
  return Status(StatusCode::kInvalidArgument, "imu: ").append(entry).append(" must be ").append(range);
}

bool lies_within(double value, double low, double high) { return value >= low && value <= high; }

}  // namespace

Status ImuConfig::validate() const {
  const Matrix3 product = R_camera_imu * R_camera_imu.transpose();
  if (!R_camera_imu.allFinite() || !((product - Matrix3::Identity()).cwiseAbs().maxCoeff() <= 1e-6))
    return refuse_entry("R_camera_imu", "a rotation or a reflection");
  if (!lies_within(gyro_noise, 1e-7, 1))
    return refuse_entry("gyro_noise", "between 1e-7 and 1 rad/s/sqrt(Hz)");
  if (!lies_within(gyro_offset_sigma, 0, 1)) return refuse_entry("gyro_offset_sigma", "0 to 1 rad/s");
  if (!lies_within(gyro_offset_walk, 0, 1)) return refuse_entry("gyro_offset_walk", "0 to 1 rad/s/sqrt(s)");
  if (!lies_within(gyro_scale_sigma, 0, 0.5)) return refuse_entry("gyro_scale_sigma", "0 to 0.5");
  if (!lies_within(accelerometer_noise, 1e-6, 10))
    return refuse_entry("accelerometer_noise", "between 1e-6 and 10 m/s^2/sqrt(Hz)");
  if (!lies_within(accelerometer_offset_sigma, 0, 5))
    return refuse_entry("accelerometer_offset_sigma", "0 to 5 m/s^2");
  if (!lies_within(acceleration, 0, 100) || !lies_within(acceleration_s, 0, 100))
    return refuse_entry("acceleration, acceleration_s", "0 to 100 m/s^2, 100 s");
  if (!lies_within(longest_gap_s, 1e-4, 10)) return refuse_entry("longest_gap_s", "between 1e-4 and 10 s");
  return {};
}

}  // namespace plvo
