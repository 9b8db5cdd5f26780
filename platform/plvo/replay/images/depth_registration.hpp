// SPDX-License-Identifier: Apache-2.0
// Registers depth images of another size, or of another camera, to the view of the colour camera.
//   same view   depth is registered to colour, only smaller or larger: each colour pixel gets the depth pixel
//               that covers its centre. Where the centre lies between two, pixels take the one before and the
//               one after alternately, so that the image does not shift by half a depth pixel.
//   own camera  each depth pixel is lifted to 3D with the depth pinhole, transformed to the colour camera and
//               projected with its lens, at the size that it has there; where several cover a pixel the
//               nearest wins. Pixels that no depth pixel covers stay 0.
// Depth is never interpolated.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/camera/camera_model.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/replay/images/image_reduction.hpp"

namespace plvo {

// The camera of depth images that are not registered to colour; it has no distortion.
struct DepthCamera {
  bool known = false;
  Pinhole pinhole = {0, 0, 0, 0};  // px of the depth image; ignored if as_colour
  // T_camera_depth: from the optical frame of depth to that of colour, metres and a quaternion.
  double tx = 0, ty = 0, tz = 0, qx = 0, qy = 0, qz = 0, qw = 1;
  bool as_colour = false;  // pinhole and image size are those of colour
};

class DepthRegistration {
 public:
  // Whether images of these sizes can have the same view: their aspect ratios agree to a pixel of depth.
  static bool same_view(int colour_width, int colour_height, int depth_width, int depth_height);

  // Allocates all memory. depth.known false: the same view. metres_per_unit: of the depth images. colour: the
  // camera of the images that depth is registered to; whole: the images that those were scaled down from.
  void init(const CameraModel& colour, const WholeImage& whole, const DepthCamera& depth, int depth_width,
            int depth_height, double metres_per_unit);

  // depth: depth_width × depth_height; registered: of the size of colour; rows without gaps. The two must not
  // overlap.
  void warp(const std::uint16_t* depth, std::uint16_t* registered) const;

 private:
  void warp_same_view(const std::uint16_t* depth, std::uint16_t* registered) const;
  void warp_own_camera(const std::uint16_t* depth, std::uint16_t* registered) const;

  CameraModel colour_;
  DepthCamera depth_;
  Se3 T_camera_depth_;
  int width_ = 0, height_ = 0;  // of depth
  double metres_per_unit_ = 0.001;
  // Index of the depth pixel for each column and row of colour; the two alternate.
  std::vector<int> column_[2], row_[2];
};

}  // namespace plvo
