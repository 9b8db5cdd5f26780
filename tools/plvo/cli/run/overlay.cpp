// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/run/overlay.hpp"

#include <fmt/core.h>

#include "plvo/replay/images/image_writer.hpp"
#include "plvo/report/drawing.hpp"

namespace plvo::cli {

Status Overlay::open(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder, error)) {
    return {StatusCode::kIo, fmt::format("cannot make the folder {}: {}; choose a path that can be written",
                                         folder, error ? error.message() : "it is a file")};
  }
  folder_ = folder;
  return {};
}

Status Overlay::write(std::size_t number, const Odometry& odometry) const {
  if (folder_.empty()) return {};
  return write_png(folder_ / fmt::format("{:06}.png", number),
                   report::draw_overlay(odometry.features()).view());
}

}  // namespace plvo::cli
