// SPDX-License-Identifier: Apache-2.0
// Recordings in containers that plvo does not read, by their names and by how their files begin.
#pragma once

#include <filesystem>

#include "plvo/base/status.hpp"

namespace plvo {

// kUnsupported, saying what it is and what to do, for MCAP and SQLite files and folders of rosbag2, for
// Matroska videos, and for ROS 1 bags under another name than FILE.bag. Ok for everything else.
Status refuse_foreign_format(const std::filesystem::path& path);

}  // namespace plvo
