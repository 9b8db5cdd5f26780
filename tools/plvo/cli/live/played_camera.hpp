// SPDX-License-Identifier: Apache-2.0
// A recording of ROS or the simulated camera in the place of a sensor.
#pragma once

#include <memory>

#include "plvo/cli/live/live_camera.hpp"

namespace plvo::cli {

// As open_camera of the recording, or of the simulated camera.
Status open_played_camera(const LiveCameraOptions& options, Log& log, std::unique_ptr<LiveCamera>& camera);

}  // namespace plvo::cli
