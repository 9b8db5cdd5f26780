// SPDX-License-Identifier: Apache-2.0
// Registers depth to the colour camera for sensors that cannot do it themselves. Each depth pixel is
// back-projected with the depth camera's pinhole, translated by the baseline, and projected by the colour
// camera (with its lens distortion, since the colour image is distorted). If several points project to one
// pixel, the nearest is kept. The geometry is nominal: both cameras have the same orientation and the colour
// camera sits kBaseline_m to the right of the depth camera, as in ROS's kinect_frames.launch (openni_launch)
// for Kinect v1, Xtion and PrimeSense sensors. Expect errors of a few pixels; registration by the sensor uses
// its own calibration and is more accurate. Pixels without a projected point are 0.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/camera/camera_model.hpp"

namespace plvo {

class SoftwareRegistration {
 public:
  static constexpr double kBaseline_m = 0.025;

  // depth: the depth camera's pinhole for an image of the colour camera's size. Allocates all memory.
  void reset(const Pinhole& depth, const CameraModel& colour, double metres_per_unit);

  // depth and registered: width × height of the colour camera, rows without gaps; they must not overlap.
  void warp(const std::uint16_t* depth, std::uint16_t* registered) const;

 private:
  CameraModel colour_;
  double metres_per_unit_ = 0.001;
  std::vector<double> x_;  // (u − cx) / fx of the depth camera per column
  std::vector<double> y_;
};

// The pinhole of an image with the field of view fov_x_rad × fov_y_rad and the principal point in the middle.
Pinhole pinhole_from_fov(int width, int height, double fov_x_rad, double fov_y_rad);

}  // namespace plvo
