// SPDX-License-Identifier: Apache-2.0
#include "plvo/recording/foreign_format.hpp"

#include <fmt/core.h>

#include <array>
#include <fstream>
#include <string>
#include <string_view>

#include "plvo/host/files/input_file.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

struct Format {
  std::string_view extension, magic;
  const char *what, *advice;
};
constexpr const char* kAsRos1 =
    "which is not read: convert it to a ROS 1 bag (rosbags-convert), or export a folder of images";
constexpr Format kFormats[] = {
    {".mcap", "\x89MCAP0\r\n"sv, "an MCAP file, as rosbag2 records", kAsRos1},
    {".db3", "SQLite format 3\0"sv, "an SQLite file (.db3), as rosbag2 records", kAsRos1},
    {".mkv", "\x1a\x45\xdf\xa3"sv, "a Matroska video (.mkv), as the Azure Kinect's recorder makes",
     "which is not read: export its colour and its depth as a folder of images"}};
constexpr std::string_view kRos1 = "#ROSBAG V";
constexpr std::size_t kLongestMagic = 16;

Status refusal(const fs::path& path, const char* what, const char* advice) {
  return {StatusCode::kUnsupported,
          fmt::format("{} is {}, {}; see share/doc/plvo/user/recordings.md", path.string(), what, advice)};
}

// The metadata identify the folder; the other files in it may be of any kind.
bool is_rosbag2_folder(const fs::path& path) {
  std::string text;
  return read_text_file(path / "metadata.yaml", kMaxTextBytes, text).ok() &&
         text.find("rosbag2_bagfile_information") != std::string::npos;
}

std::string beginning_of(const fs::path& path) {
  std::array<char, kLongestMagic> bytes{};
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), bytes.size());
  return {bytes.data(), static_cast<std::size_t>(file.gcount())};
}

}  // namespace

Status refuse_foreign_format(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error))
    return is_rosbag2_folder(path) ? refusal(path, "a folder of rosbag2 (ROS 2)", kAsRos1) : Status();
  if (!fs::is_regular_file(path, error)) return {};
  const std::string beginning = beginning_of(path);
  for (const Format& format : kFormats)
    if (path.extension() == format.extension || beginning.starts_with(format.magic))
      return refusal(path, format.what, format.advice);
  if (beginning.starts_with(kRos1) && path.extension() != ".bag")
    return refusal(path, "a ROS 1 bag", "which is read under a name that ends in .bag: rename it");
  return {};
}

}  // namespace plvo
