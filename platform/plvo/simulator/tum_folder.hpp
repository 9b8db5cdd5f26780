// SPDX-License-Identifier: Apache-2.0
// Writes what a camera sees as a folder in the layout of the TUM RGB-D benchmark: rgb/ depth/ rgb.txt
// depth.txt calibration.txt groundtruth.txt. Lists are brought up to date after every frame, so that a full
// disk or an interruption leaves a folder that can be read up to there.
#pragma once

#include <functional>
#include <string>

#include "plvo/base/status.hpp"
#include "plvo/simulator/simulated_camera.hpp"

namespace plvo {

// Called after each frame: frames written so far, frames there will be. Returning false stops, with an ok
// status.
using WriteProgress = std::function<bool(int written, int total)>;

// Creates `folder` if it is missing. kInvalidArgument when it holds another recording, kPermission when it
// may not be written, kIo (disk full and the like) with the operating system's reason.
Status write_tum_folder(SimulatedCamera& camera, const std::string& folder,
                        const WriteProgress& progress = {});

}  // namespace plvo
