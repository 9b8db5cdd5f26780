// SPDX-License-Identifier: Apache-2.0
// What can take the place of a sensor: a recording of ROS or the simulated camera, as a live camera; and any
// of them, or an .oni file, at the pace of its stamps.
#pragma once

#include <memory>

#include "plvo/cli/live/live_camera.hpp"

namespace plvo::cli {

// As open_camera of the recording, or of the simulated camera.
Status open_played_camera(const LiveCameraOptions& options, Log& log, std::unique_ptr<LiveCamera>& camera);

// The same camera, which delivers a frame no earlier than its stamp says (PacedCamera). A signal ends the
// wait.
std::unique_ptr<LiveCamera> at_own_pace(std::unique_ptr<LiveCamera> camera);

}  // namespace plvo::cli
