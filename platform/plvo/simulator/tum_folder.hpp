// SPDX-License-Identifier: Apache-2.0
// Writes what a simulated camera sees as a folder in the layout of the TUM RGB-D benchmark, by replay's
// TumWriter, with the exact poses in groundtruth.txt, and what a gyro and an accelerometer beside the camera
// read in gyroscope.txt and accelerometer.txt.
#pragma once

#include <functional>
#include <string>

#include "plvo/base/status.hpp"
#include "plvo/simulator/simulated_camera.hpp"

namespace plvo {

// Called after each frame: frames written so far, frames there will be. Returning false stops, with an ok
// status.
using WriteProgress = std::function<bool(int written, int total)>;

// Creates `folder` if it is missing. kInvalidArgument when it holds another recording, kIo (no permission,
// disk full and the like) with the operating system's reason; what was written so far is valid.
Status write_tum_folder(SimulatedCamera& camera, const std::string& folder,
                        const WriteProgress& progress = {});

}  // namespace plvo
