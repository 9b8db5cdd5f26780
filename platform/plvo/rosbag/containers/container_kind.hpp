// SPDX-License-Identifier: Apache-2.0
// Which container a recording of messages is, told by its first bytes and its name. Needs none of the
// libraries that read it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace plvo {

enum class Container : std::uint8_t { kNone, kBag, kMcap, kSqlite, kFolder };

// By the first bytes of a file, where there are any; else by its extension. A folder is one if it has files
// of rosbag2, or its metadata.yaml. Anything else is kNone.
Container container_of(const std::filesystem::path& path);

// .bag, .mcap and .db3, each also with .zstd behind it.
Container by_extension(const std::filesystem::path& path);

std::vector<std::filesystem::path> bag_files_in(const std::filesystem::path& folder);

// The first 16 bytes; fewer for a shorter file, none for what is no regular file.
std::string first_bytes_of(const std::filesystem::path& path);

}  // namespace plvo
