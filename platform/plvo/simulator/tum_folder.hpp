// SPDX-License-Identifier: Apache-2.0
// Writes the frames of a simulated camera to a folder in the layout of the TUM RGB-D benchmark, using
// replay's TumWriter. groundtruth.txt contains the exact poses; gyroscope.txt and accelerometer.txt contain
// the samples of the inertial sensors, wheel_odometry.txt those of a robot's wheels.
#pragma once

#include <functional>
#include <string>

#include "plvo/base/status.hpp"
#include "plvo/simulator/simulated_camera.hpp"

namespace plvo {

// Called after each frame with the number of frames written and the total. Returning false stops with an ok
// status.
using WriteProgress = std::function<bool(int written, int total)>;

// Creates `folder` if it is missing. Returns kInvalidArgument if it contains another recording, and kIo (no
// permission, disk full, …) with the reason of the operating system; the frames written so far remain valid.
Status write_tum_folder(SimulatedCamera& camera, const std::string& folder,
                        const WriteProgress& progress = {});

}  // namespace plvo
