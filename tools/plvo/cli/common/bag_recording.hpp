// SPDX-License-Identifier: Apache-2.0
// A ROS 1 bag as the sequence of a command.
#pragma once

#include <string>

#include "plvo/cli/common/camera_options.hpp"

namespace plvo::cli {

bool is_bag_file(const std::string& path);  // by its name, .bag

// As open_camera. kUnsupported, with what to install, where plvo was built without bags.
Status open_bag(const CameraOptions& options, const SequenceOptions& sequence, Log& log,
                OpenedCamera& opened);

}  // namespace plvo::cli
