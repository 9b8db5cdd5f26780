// SPDX-License-Identifier: Apache-2.0
// Calibrations that can be taken, but are hardly those of the camera.
#pragma once

#include <string>
#include <vector>

#include "plvo/camera/camera_model.hpp"

namespace plvo {

// A sentence for each doubt, with its usual cause and what to do; empty for a plausible camera. camera: of
// images of width × height, as they were recorded. Doubtful is:
// the principal point is more than a tenth of the image from its middle; fx and fy differ by more than 5 %;
// the image shows less than 15° or more than 150°.
std::vector<std::string> doubts_about(const CameraModel& camera, int width, int height);

}  // namespace plvo
