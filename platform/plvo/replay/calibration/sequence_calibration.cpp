// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/calibration/sequence_calibration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "plvo/replay/calibration/scannet_cameras.hpp"
#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/replay/index/sequence_index.hpp"

namespace plvo {

namespace fs = std::filesystem;

namespace {

// Colour and depth of the first pair whose headers can be read.
bool sizes_differ(const fs::path& folder) {
  SequenceIndex index;
  if (!read_sequence_index(folder, {}, index).ok()) return false;
  ImageDecoder decoder;
  for (const ImagePair& pair : index.pairs) {
    ImageInfo colour, depth;
    if (decoder.read_header(folder / pair.colour.file, colour).ok() &&
        decoder.read_header(folder / pair.depth.file, depth).ok())
      return colour.width != depth.width || colour.height != depth.height;
  }
  return false;
}

// No calibration of the user's comes before.
bool is_scannets(const fs::path& folder, const fs::path& file) {
  const std::vector<fs::path> files = scannet_camera_files(folder);
  return std::find(files.begin(), files.end(), file) != files.end();
}

}  // namespace

Status sequence_calibration(const fs::path& folder, Calibration& calibration, std::string& guess) {
  guess.clear();
  if (const std::optional<fs::path> file = calibration_file_in(folder)) {
    if (is_scannets(folder, *file) && has_scannet_cameras(folder) && sizes_differ(folder))
      return read_scannet_cameras(folder, calibration);
    return read_calibration(*file, calibration);
  }
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

std::vector<fs::path> calibration_files_in(const fs::path& folder) {
  const std::optional<fs::path> file = calibration_file_in(folder);
  if (!file) return {};
  return is_scannets(folder, *file) ? scannet_camera_files(folder) : std::vector<fs::path>{*file};
}

}  // namespace plvo
