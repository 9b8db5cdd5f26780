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

// By the first bytes of a file, where there are any; else by its extension. A folder is one if it has
// rosbag2's metadata.yaml, or files of rosbag2 and no images. Anything else is kNone.
Container container_of(const std::filesystem::path& path);

// Whether the name ends in .zstd, as rosbag2 names packed files, or .zst, as the program zstd does.
bool has_packed_name(const std::filesystem::path& path);

// .bag, .mcap and .db3, each also packed.
Container by_extension(const std::filesystem::path& path);

std::vector<std::filesystem::path> bag_files_in(const std::filesystem::path& folder);

// The first 16 bytes; fewer for a shorter file, none for what is no regular file.
std::string first_bytes_of(const std::filesystem::path& path);

}  // namespace plvo
