// SPDX-License-Identifier: Apache-2.0
// What an inertial sensor is good for. The defaults are those of a cheap part (MPU-6050: noise of its data
// sheet, offsets as they remain of the data sheet's tolerance after a calibration at rest).
#pragma once

#include "plvo/base/status.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

inline constexpr double kStandardGravity = 9.80665;  // m/s²

struct ImuConfig {
  // Turns the sensor's axes into the camera's (x right, y down, z forward). A reflection where the sensor's
  // are of the other hand, as a Kinect's accelerometer's: x right, y up, z forward.
  Matrix3 R_camera_imu = Matrix3::Identity();

  double gyro_noise = 8.7e-5;       // rad/s/√Hz, white
  double gyro_offset_sigma = 0.02;  // rad/s, at the start, of each axis; learnt from what is seen
  double gyro_offset_walk = 1e-4;   // rad/s/√s, how it wanders
  double gyro_scale_sigma = 0.01;   // share of the rate, of each axis

  double accelerometer_noise = 4e-3;         // m/s²/√Hz, white
  double accelerometer_offset_sigma = 0.25;  // m/s², of each axis
  // What the camera itself is accelerated by, SD of each axis in m/s², and for how long in one go, s.
  double acceleration = 0.6, acceleration_s = 0.1;

  double longest_gap_s = 0.05;  // between samples; over a longer one nothing is said

  // kInvalidArgument, naming the entry and its range.
  Status validate() const;
};

}  // namespace plvo
