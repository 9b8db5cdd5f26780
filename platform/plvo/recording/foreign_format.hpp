// SPDX-License-Identifier: Apache-2.0
// Detects recordings in containers that plvo does not read, by their names and the first bytes of the files.
#pragma once

#include <filesystem>

#include "plvo/base/status.hpp"

namespace plvo {

// Returns kUnsupported, with the format and the remedy, for MCAP and SQLite files and folders of rosbag2, for
// Matroska videos, and for ROS 1 bags with another name than FILE.bag. Returns ok for everything else.
Status refuse_foreign_format(const std::filesystem::path& path);

}  // namespace plvo
