// SPDX-License-Identifier: Apache-2.0
// Finds calibrations that are valid but hardly those of the camera.
#pragma once

#include <string>
#include <vector>

#include "plvo/camera/camera_model.hpp"

namespace plvo {

// Returns a sentence for each doubt, with its usual cause and the remedy; empty for a plausible camera.
// camera: of images of width × height, as recorded. A calibration is doubtful if the principal point is more
// than a tenth of the image from its middle, if fx and fy differ by more than 5 %, or if the image shows less
// than 15° or more than 150°.
std::vector<std::string> doubts_about(const CameraModel& camera, int width, int height);

}  // namespace plvo
