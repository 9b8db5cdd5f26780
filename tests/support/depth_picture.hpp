// SPDX-License-Identifier: Apache-2.0
// A depth image made from a function of the pixel, in metres, without a lens.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "plvo/image/depth_sampler.hpp"

namespace plvo::test {

class DepthPicture {
 public:
  static constexpr double kUnit = 1e-4;  // m

  // depth_m(x, y): 0 for none; what is too far for the unit is none either.
  template <typename Function>
  DepthPicture(int width, int height, Function depth_m)
      : width_(width), height_(height), units_(static_cast<std::size_t>(width * height)) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double units = std::floor(depth_m(x, y) / kUnit + 0.5);
        units_[static_cast<std::size_t>(y * width + x)] =
            units < 65536 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
      }
  }
  DepthSampler sampler(const Exposure& exposure = {}) const {
    return {{units_.data(), width_, height_, width_, kUnit}, map_, DepthNoise{}, exposure};
  }

 private:
  int width_, height_;
  std::vector<std::uint16_t> units_;
  UndistortionMap map_;
};

// Where the ray of a pixel meets the plane n · X = d; 0 behind the camera.
inline double depth_of_plane(const Pinhole& pinhole, double x, double y, const Vector3& n, double d) {
  const double z = d / n.dot(back_project(pinhole, x, y, 1));
  return z > 0 ? z : 0;
}

}  // namespace plvo::test
