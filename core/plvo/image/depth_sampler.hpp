// SPDX-License-Identifier: Apache-2.0
// Reads the depth that belongs to a pixel of the undistorted grey image. On a depth edge a keypoint belongs
// to the nearer surface (it is the nearer surface's outline), but registration and the lens leave the edge a
// pixel or two off: so a small window is looked at, a plane is fitted to the nearer surface's depths, and a
// mixed window says so.
#pragma once

#include <cstdint>

#include "plvo/camera/depth_noise.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/image/undistortion.hpp"

namespace plvo {

struct DepthSample {
  double depth_m = 0;    // 0: none
  double sigma_m = 0;    // σ_d of equation (2), widened by what the window showed
  bool on_edge = false;  // the window holds a second surface behind this one
};

class DepthSampler {
 public:
  DepthSampler(const DepthView& depth, const UndistortionTable& table, const DepthNoise& noise)
      : depth_(depth), table_(table), noise_(noise) {}

  // Depth at one pixel, in metres, 0 where there is none or (x, y) is outside the image.
  double at(int x, int y) const {
    int raw_x = 0;
    int raw_y = 0;
    if (x < 0 || y < 0 || x >= depth_.width || y >= depth_.height || !table_.raw_pixel(x, y, raw_x, raw_y))
      return 0;
    return depth_.data[raw_y * depth_.stride + raw_x] * depth_.metres_per_unit;
  }

  static constexpr int kMaxRadius = 3;
  // The depth at (u, v), inside the image, from a plane fitted to the window of (2·radius+1)² pixels around
  // it.
  DepthSample sample(double u, double v, int radius = 2) const;

  const DepthNoise& noise() const { return noise_; }

 private:
  DepthView depth_;
  const UndistortionTable& table_;
  DepthNoise noise_;
};

}  // namespace plvo
