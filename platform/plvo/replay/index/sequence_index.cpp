// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/index/sequence_index.hpp"

#include <fmt/core.h>

#include <system_error>

#include "plvo/replay/index/numbered_index.hpp"
#include "plvo/replay/index/tum_index.hpp"
#include "plvo/replay/small_letters.hpp"

namespace plvo {

namespace fs = std::filesystem;

namespace {

// A name that consists of the extension alone does not count.
bool ends(std::string_view name, std::string_view extension) {
  return name.size() > extension.size() &&
         in_small_letters(name.substr(name.size() - extension.size())) == extension;
}

}  // namespace

Status read_sequence_index(const fs::path& folder, const SequenceOptions& options, SequenceIndex& index) {
  index = {};
  std::error_code error;
  if (fs::is_regular_file(folder, error) && folder.extension() == ".oni") {
    return {StatusCode::kUnsupported,
            fmt::format(
                "{0} is a recording of OpenNI2, not a folder of images: plvo live --device {0} plays it, and "
                "plvo record FOLDER --device {0} makes a folder of it",
                folder.string())};
  }
  if (!fs::is_directory(folder, error)) {
    return {
        StatusCode::kNotFound,
        fmt::format(
            "{} is not a folder; name the folder of a recorded sequence, or a file .bag, .mcap, .db3 or .oni",
            folder.string())};
  }
  if (options.associations.empty() && is_numbered_folder(folder))
    return read_numbered_index(folder, options.frames_per_s, index);
  return read_tum_index(folder, options.associations, options.tolerance_ns, index);
}

Status read_ground_truth(const fs::path& folder, const SequenceOptions& options, Trajectory& trajectory) {
  trajectory = {};
  std::error_code error;
  if (const fs::path file = folder / "groundtruth.txt"; fs::exists(file, error))
    return read_trajectory({file, {}, {}}, trajectory);
  SequenceIndex index;
  if (is_numbered_folder(folder))
    if (Status status = read_numbered_index(folder, options.frames_per_s, index); !status.ok()) return status;
  if (!index.poses.empty()) return read_numbered_poses(folder, index.poses, trajectory);
  return {StatusCode::kNotFound,
          fmt::format("{} has neither groundtruth.txt nor a pose file for each numbered "
                      "frame; name a trajectory's file",
                      folder.string())};
}

bool ends_as_image(std::string_view name) {
  return ends(name, ".png") || ends_as_jpeg(name) || ends(name, ".ppm") || ends(name, ".pgm");
}

bool ends_as_jpeg(std::string_view name) { return ends(name, ".jpg") || ends(name, ".jpeg"); }

}  // namespace plvo
