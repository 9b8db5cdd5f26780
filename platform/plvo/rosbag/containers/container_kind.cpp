// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/containers/container_kind.hpp"

#include <array>
#include <fstream>
#include <string_view>

#include "plvo/host/files/input_file.hpp"
#include "plvo/replay/index/numbered_index.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

struct ContainerKind {
  Container container;
  std::string_view extension, magic;
};
constexpr ContainerKind kContainers[] = {{Container::kBag, ".bag", "#ROSBAG V"sv},
                                         {Container::kMcap, ".mcap", "\x89MCAP"sv},
                                         {Container::kSqlite, ".db3", "SQLite format 3\0"sv}};

bool is_bag_folder(const fs::path& folder) {
  std::error_code error;
  for (const char* list : {"rgb.txt", "associations.txt"})
    if (fs::exists(folder / list, error)) return false;
  std::string text;
  if (read_text_file(folder / "metadata.yaml", kMaxTextBytes, text).ok() &&
      text.find("rosbag2_bagfile_information") != std::string::npos)
    return true;
  return !bag_files_in(folder).empty() && !is_numbered_folder(folder);
}

}  // namespace

std::string first_bytes_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};
  std::array<char, 16> bytes{};
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), bytes.size());
  return {bytes.data(), static_cast<std::size_t>(file.gcount())};
}

bool has_packed_name(const fs::path& path) {
  return path.extension() == ".zstd" || path.extension() == ".zst";
}

Container by_extension(const fs::path& path) {
  const fs::path name = has_packed_name(path) ? path.stem() : path;
  for (const ContainerKind& kind : kContainers)
    if (name.extension() == kind.extension) return kind.container;
  return Container::kNone;
}

std::vector<fs::path> bag_files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const Container kind = by_extension(entry->path());
    if (kind == Container::kMcap || kind == Container::kSqlite) files.push_back(entry->path());
  }
  return files;
}

Container container_of(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return is_bag_folder(path) ? Container::kFolder : Container::kNone;
  const std::string first = first_bytes_of(path);
  for (const ContainerKind& kind : kContainers)
    if (first.starts_with(kind.magic)) return kind.container;
  return by_extension(path);
}

}  // namespace plvo
