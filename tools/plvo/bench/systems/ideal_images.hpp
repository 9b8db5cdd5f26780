// SPDX-License-Identifier: Apache-2.0
// Input images for systems without a lens distortion model: the images of a pinhole camera with the same
// focal length. Colour is interpolated linearly and delivered as RGB. Depth is taken from the nearest pixel,
// since the mean of two surfaces lies on neither. Pixels that the camera does not observe are black and have
// no depth.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/camera/camera_model.hpp"
#include "plvo/image/frame.hpp"

namespace plvo::bench {

class IdealImages {
 public:
  explicit IdealImages(const CameraModel& camera);

  void make(const RgbdFrame& frame);

  int width() const { return width_; }
  int height() const { return height_; }
  std::uint8_t* rgb() { return rgb_.data(); }       // 3 × width × height
  std::uint16_t* depth() { return depth_.data(); }  // width × height, in the frame's units, 0: no depth

 private:
  struct Source {
    int x = -1, y = -1;  // upper left of four neighbouring pixels; −1 where the camera observes nothing
    float u = 0, v = 0;
  };

  int width_, height_;
  std::vector<Source> sources_;
  std::vector<std::uint8_t> rgb_;
  std::vector<std::uint16_t> depth_;
};

}  // namespace plvo::bench
