// SPDX-License-Identifier: Apache-2.0
// `--overlay DIR`: a PNG for each frame, with what was found and matched drawn on the image.
#pragma once

#include <filesystem>
#include <string>

#include "plvo/odometry/odometry.hpp"

namespace plvo::cli {

class Overlay {
 public:
  // Makes the folder. Until then, write() does nothing. kIo with the operating system's reason.
  Status open(const std::string& folder);
  // DIR/000042.png
  Status write(std::size_t number, const Odometry& odometry) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace plvo::cli
