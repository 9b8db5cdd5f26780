// SPDX-License-Identifier: Apache-2.0
// Noise model of an inertial sensor. The defaults are those of a cheap part (MPU-6050: the noise of its data
// sheet; the offsets that remain of the data sheet's tolerance after a calibration at rest).
#pragma once

#include "plvo/base/status.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

inline constexpr double kStandardGravity = 9.80665;  // m/s²

struct ImuConfig {
  // Rotates the sensor's axes into the camera's (x right, y down, z forward). It is a reflection if the
  // sensor's axes have the other handedness, like those of a Kinect's accelerometer: x right, y up, z
  // forward.
  Matrix3 R_camera_imu = Matrix3::Identity();

  double gyro_noise = 8.7e-5;       // rad/s/√Hz, white
  double gyro_offset_sigma = 0.02;  // rad/s, SD per axis at the start; learnt while tracking
  double gyro_offset_walk = 1e-4;   // rad/s/√s, random walk
  double gyro_scale_sigma = 0.01;   // share of the rate, of each axis

  double accelerometer_noise = 4e-3;         // m/s²/√Hz, white
  double accelerometer_offset_sigma = 0.25;  // m/s², of each axis
  // Acceleration of the camera itself: SD of each axis in m/s², and how long it lasts, in s.
  double acceleration = 0.6, acceleration_s = 0.1;

  double longest_gap_s = 0.05;  // between samples; over a longer gap there is no prior

  // Returns kInvalidArgument, naming the entry and its range.
  Status validate() const;
};

}  // namespace plvo
