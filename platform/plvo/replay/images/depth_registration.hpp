// SPDX-License-Identifier: Apache-2.0
// Depth images of another size, or of another camera, as the colour camera would have seen them.
//   same view   depth is registered to colour, only smaller or larger: each colour pixel gets the depth pixel
//               that covers its middle. Where the middle lies between two, pixels get the one before and the
//               one after in turns, so that the whole does not move by half a depth pixel.
//   own camera  each depth pixel is taken to 3D by depth's pinhole, moved to the colour camera, and imaged by
//               it with its lens, as large as it is seen from there; where several land on one pixel the
//               nearest wins. Pixels that no depth pixel lands on stay 0.
// Depth is never blended.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/camera/camera_model.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/replay/images/image_reduction.hpp"

namespace plvo {

// Of the images that are not registered to colour: no lens.
struct DepthCamera {
  bool known = false;
  Pinhole pinhole = {0, 0, 0, 0};  // px of the depth image; not looked at where it is colour's
  // T_camera_depth: from depth's optical frame to colour's, metres and a quaternion.
  double tx = 0, ty = 0, tz = 0, qx = 0, qy = 0, qz = 0, qw = 1;
  bool as_colour = false;  // the pinhole is colour's, and so is the size of the images
};

class DepthRegistration {
 public:
  // Whether images of these sizes can have the same view: their shapes agree to a pixel of depth.
  static bool same_view(int colour_width, int colour_height, int depth_width, int depth_height);

  // Takes all memory. depth.known false: the same view. metres_per_unit: of the depth images.
  // colour: the camera of the images that depth is for; whole: from what those were scaled down.
  void init(const CameraModel& colour, const WholeImage& whole, const DepthCamera& depth, int depth_width,
            int depth_height, double metres_per_unit);

  // depth: depth_width × depth_height; registered: of colour's size; rows without gaps; they must not
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
  // Of the depth pixel, for each column and row of colour: by turns.
  std::vector<int> column_[2], row_[2];
};

}  // namespace plvo
