// SPDX-License-Identifier: Apache-2.0
// Depth seen from the colour camera, for sensors that cannot do it themselves. Each depth pixel is taken to
// 3D with the depth camera's pinhole, moved by the baseline, and imaged by the colour camera (with its lens,
// for the colour image has it too); where several land on one pixel the nearest wins. The geometry is
// nominal: both cameras look the same way and the colour camera sits kBaseline_m to the right of the depth
// camera, as in ROS's kinect_frames.launch (openni_launch) for Kinect v1, Xtion and PrimeSense sensors.
// Expect errors of a few pixels; a sensor that registers by itself knows its own calibration and is better.
// Pixels that no depth pixel lands on stay 0.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/camera/camera_model.hpp"

namespace plvo {

class SoftwareRegistration {
 public:
  static constexpr double kBaseline_m = 0.025;

  // depth: the depth camera's pinhole for an image of the colour camera's size. Takes all its memory here.
  void reset(const Pinhole& depth, const CameraModel& colour, double metres_per_unit);

  // depth and registered: width × height of the colour camera, rows without gaps; they must not overlap.
  void warp(const std::uint16_t* depth, std::uint16_t* registered) const;

 private:
  CameraModel colour_;
  double metres_per_unit_ = 0.001;
  std::vector<double> x_;  // (u − cx) / fx of the depth camera per column
  std::vector<double> y_;
};

// The pinhole of an image that sees fov_x_rad × fov_y_rad, principal point in the middle.
Pinhole pinhole_from_fov(int width, int height, double fov_x_rad, double fov_y_rad);

}  // namespace plvo
