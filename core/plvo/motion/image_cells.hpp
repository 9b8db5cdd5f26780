// SPDX-License-Identifier: Apache-2.0
// Square cells of the image, independent of the camera's resolution.
#pragma once

#include <algorithm>
#include <cstddef>

#include "plvo/math/types.hpp"

namespace plvo {

// The grid is wider than the image of any lens but a fisheye; what lies beyond it is in its border.
struct ImageCells {
  static constexpr double kWidth = 0.075;  // in the plane z = 1: 40 pixels of a Kinect
  static constexpr int kSide = 32;         // cells along each side of the grid
  static constexpr std::size_t kCount = std::size_t{kSide} * kSide;

  // The cell of a point in camera coordinates, z > 0; row-major. Not inlined: called at many places.
  [[gnu::noinline]] static std::size_t at(const Vector3& p) {
    const auto along = [](double x) {
      return static_cast<std::size_t>(std::clamp(x / kWidth + kSide / 2, 0.0, kSide - 1.0));
    };
    const double inverse = 1 / p.z();
    return along(p.y() * inverse) * kSide + along(p.x() * inverse);
  }
};

}  // namespace plvo
