// SPDX-License-Identifier: Apache-2.0
// Saved maps (map/map_file.hpp) as files. A map is written to PATH.part and then takes the name PATH, so that
// an older map is there until the new one is whole. What is no regular file (standard output, a pipe, a
// device) is written directly.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/map/map.hpp"

namespace plvo {

// What save_map() would say of the path. A long run, which saves its map at the end, asks before it begins.
Status check_map_output(const std::filesystem::path& path);

// The status of Map::save, or kIo. On failure the file that was there stays as it is.
Status save_map(const std::filesystem::path& path, Map& map);

// The statuses of read_input_file and Map::load; all name the path.
Status load_map(const std::filesystem::path& path, Map& map);

// A file as a map of its own, with a camera and limits that it fits.
class StoredMap {
 public:
  Status open(const std::filesystem::path& path);
  const MapFileInfo& info() const { return info_; }
  const Map& map() const { return map_; }
  std::size_t memory_bytes() const { return memory_.size(); }

 private:
  MapFileInfo info_;
  std::vector<std::byte> memory_;
  Map map_;
};

}  // namespace plvo
