// SPDX-License-Identifier: Apache-2.0
// Opens a recording of messages, whichever container it is.
#pragma once

#include <filesystem>
#include <memory>

#include "plvo/rosbag/containers/message_file.hpp"

namespace plvo {

// Opens a container, without reading its messages. A packed file is unpacked to the folder for temporary
// files (TMPDIR), where it has no name. Returns the errors of MessageFile::open; kNotFound; kIo if the disk
// is full.
Status open_container(const std::filesystem::path& path, std::unique_ptr<MessageFile>& file);

// The same, and reads it once.
Status open_messages(const std::filesystem::path& path, std::unique_ptr<MessageFile>& file);

}  // namespace plvo
