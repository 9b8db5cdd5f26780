// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/calibration/sequence_calibration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "plvo/replay/calibration/scannet_cameras.hpp"
#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/replay/index/sequence_index.hpp"

namespace plvo {

namespace fs = std::filesystem;

namespace {

// Compares colour and depth of the first pair whose headers can be read.
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

// Whether the file is one of ScanNet's; a calibration of the user's would have come first.
bool is_scannets(const fs::path& folder, const fs::path& file) {
  const std::vector<fs::path> files = scannet_camera_files(folder);
  return std::find(files.begin(), files.end(), file) != files.end();
}

// If no file has a known name: the only file in a format of program settings, whatever its name.
std::optional<fs::path> only_settings_in(const fs::path& folder) {
  std::optional<fs::path> only;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path extension = entry->path().extension();
    if (extension != ".yaml" && extension != ".yml" && extension != ".json") continue;
    if (only) return {};
    only = entry->path();
  }
  return only;
}

std::string name_of(const fs::path& recording) {
  const fs::path normal = recording.lexically_normal();
  return (normal.filename().empty() ? normal.parent_path() : normal).filename().string();
}

constexpr std::array<std::string_view, 3> kTumModels = {"tum-fr1", "tum-fr2", "tum-fr3"};

// The camera's name in the names of the benchmark's recordings; empty for another name.
std::string_view tum_model_of(std::string_view name) {
  for (const std::string_view model : kTumModels)
    if (name.starts_with(fmt::format("rgbd_dataset_freiburg{}_", model.back()))) return model;
  return {};
}

// Matches names that users give such recordings, but other recordings may have them too.
std::string_view tum_model_perhaps(std::string_view name) {
  for (const std::string_view model : kTumModels)
    if (name.find(fmt::format("freiburg{}", model.back())) != name.npos ||
        name.starts_with(fmt::format("fr{}_", model.back())))
      return model;
  return {};
}

// The benchmark also publishes them with one digit after the point.
bool same_pinhole(const Pinhole& a, const Pinhole& b) {
  constexpr double kRounded_px = 0.1;
  return std::abs(a.fx - b.fx) < kRounded_px && std::abs(a.fy - b.fy) < kRounded_px &&
         std::abs(a.cx - b.cx) < kRounded_px && std::abs(a.cy - b.cy) < kRounded_px;
}

std::string_view tum_model_of(const Calibration& calibration) {
  for (const std::string_view model : kTumModels) {
    Calibration builtin;
    if (builtin_calibration(model, builtin).ok() &&
        same_pinhole(builtin.camera.pinhole, calibration.camera.pinhole))
      return model;
  }
  return {};
}

}  // namespace

Status sequence_calibration(const fs::path& folder, Calibration& calibration, std::string& guess) {
  guess.clear();
  if (const std::optional<fs::path> file = calibration_file_in(folder)) {
    if (is_scannets(folder, *file) && has_scannet_cameras(folder) && sizes_differ(folder))
      return read_scannet_cameras(folder, calibration);
    return read_calibration(*file, calibration);
  }
  std::string why;
  if (const std::optional<fs::path> file = only_settings_in(folder)) {
    const Status status = read_calibration(*file, calibration);
    if (status.ok()) {
      guess = fmt::format("no file has a calibration's name; {}, the folder's only settings, is taken for it",
                          file->string());
      return {};
    }
    why = fmt::format("; {}", status.message());
  }
  const std::string name = name_of(folder);
  if (const std::string_view model = tum_model_of(name); !model.empty()) {
    guess = fmt::format("{} has no calibration file; by its name it is of the camera {}, which is assumed",
                        name, model);
    return builtin_calibration(model, calibration);
  }
  if (const std::string_view model = tum_model_perhaps(name); !model.empty())
    why = fmt::format("; if it is TUM's, as its name may say: --camera-model {}{}", model, why);
  return {StatusCode::kNotFound, fmt::format("{} has no calibration file{}", name, why)};
}

std::string missing_of_tum(const fs::path& recording, const Calibration& calibration) {
  const std::string_view by_name = tum_model_of(name_of(recording));
  const std::string_view model = by_name.empty() ? tum_model_of(calibration) : by_name;
  Calibration whole;
  if (model.empty() || !builtin_calibration(model, whole).ok()) return {};
  const CameraModel& known = whole.camera;
  const CameraModel& said = calibration.camera;
  std::string missing;
  const auto add = [&missing](bool lacks, std::string_view what) {
    if (lacks) missing.append(missing.empty() ? "" : ", ").append(what);
  };
  add(!known.distortion.is_zero() && said.distortion.is_zero(), "the lens");
  add(!calibration.readout_given, "the rolling shutter");
  add(known.depth_timing.known && !said.depth_timing.known, "when depth is exposed");
  add(known.stamp_sigma_s > 0 && said.stamp_sigma_s == 0, "the errors of the stamps");
  if (missing.empty()) return {};
  return fmt::format(
      "by its {} this is TUM's camera {}, of which the calibration does not say: {}; "
      "--camera-model {} says it, and gives smaller errors",
      by_name.empty() ? "numbers" : "name", model, missing, model);
}

std::vector<fs::path> calibration_files_in(const fs::path& folder) {
  std::optional<fs::path> file = calibration_file_in(folder);
  if (!file) file = only_settings_in(folder);
  if (!file) return {};
  return is_scannets(folder, *file) ? scannet_camera_files(folder) : std::vector<fs::path>{*file};
}

}  // namespace plvo
