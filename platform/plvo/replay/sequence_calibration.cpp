// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/sequence_calibration.hpp"

#include <fmt/core.h>

#include <optional>

namespace plvo {

namespace fs = std::filesystem;

Status sequence_calibration(const fs::path& folder, Calibration& calibration, std::string& guess) {
  guess.clear();
  if (const std::optional<fs::path> file = calibration_file_in(folder))
    return read_calibration(*file, calibration);
  const fs::path normal = folder.lexically_normal();
  const std::string name = (normal.filename().empty() ? normal.parent_path() : normal).filename().string();
  for (const char* number : {"1", "2", "3"}) {
    if (name.find(std::string("freiburg") + number) == std::string::npos &&
        name.rfind(std::string("fr") + number + '_', 0) != 0)
      continue;
    const std::string model = std::string("tum-fr") + number;
    guess = fmt::format("{} has no calibration.txt; by its name it is of the camera {}, which is assumed",
                        name, model);
    return builtin_calibration(model, calibration);
  }
  return {StatusCode::kNotFound,
          fmt::format("{} has no calibration.txt, and its name speaks of no TUM camera", folder.string())};
}

}  // namespace plvo
