// SPDX-License-Identifier: Apache-2.0
#include "plvo/recording/foreign_format.hpp"

#include <fmt/core.h>

#include "plvo/rosbag/containers/container_kind.hpp"

namespace plvo {

Status refuse_foreign_format(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  if (path.extension() != ".mkv" && !first_bytes_of(path).starts_with("\x1a\x45\xdf\xa3")) return {};
  return {
      StatusCode::kUnsupported,
      fmt::format(
          "{} is a Matroska video (.mkv), as the Azure Kinect's recorder makes, which is not read: "
          "export its colour and its depth as a folder of images; see share/doc/plvo/user/ros_recordings.md",
          path.string())};
}

}  // namespace plvo
