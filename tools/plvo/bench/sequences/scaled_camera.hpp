// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "plvo/camera/camera_model.hpp"

namespace plvo::bench {

// The same view in an image whose width and height are multiplied by `scale`.
inline CameraModel scaled(const CameraModel& camera, double scale) {
  CameraModel result = camera;
  result.width = static_cast<int>(camera.width * scale);
  result.height = static_cast<int>(camera.height * scale);
  // (0, 0) is the centre of the first pixel.
  result.pinhole = {camera.pinhole.fx * scale, camera.pinhole.fy * scale,
                    (camera.pinhole.cx + 0.5) * scale - 0.5, (camera.pinhole.cy + 0.5) * scale - 0.5};
  return result;
}

}  // namespace plvo::bench
