// SPDX-License-Identifier: Apache-2.0
// A recording of ROS in the place of a sensor: for the live view, the pose stream, and to make a folder of
// it.
#pragma once

#include <memory>

#include "plvo/cli/live/live_camera.hpp"

namespace plvo::cli {

// As open_camera of the recording.
Status open_bag_device(const LiveCameraOptions& options, Log& log, std::unique_ptr<LiveCamera>& camera);

}  // namespace plvo::cli
