// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/tum_writer.hpp"

#include <fmt/core.h>

#include "plvo/host/files/stamp_text.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/replay/images/image_writer.hpp"

namespace plvo {

namespace fs = std::filesystem;

Status TumWriter::open(const fs::path& folder, const Calibration& calibration) {
  folder_ = folder;
  std::error_code error;
  for (const char* list : {"rgb.txt", "depth.txt"}) {
    if (fs::exists(folder / list, error))
      return {StatusCode::kInvalidArgument,
              fmt::format("{} already holds a recording; choose another folder or remove it first",
                          folder.string())};
  }
  for (const fs::path& path : {folder, folder / "rgb", folder / "depth"}) {
    fs::create_directories(path, error);
    if (error || !fs::is_directory(path, error)) {
      return {StatusCode::kIo, fmt::format("cannot make the folder {}: {}; choose a path that can be written",
                                           path.string(), error ? error.message() : "it is a file")};
    }
  }
  LineFile text;
  Status status = text.open(folder / "calibration.txt", calibration_text(calibration));
  if (status.ok()) status = colour_list_.open(folder / "rgb.txt", "# timestamp filename");
  if (status.ok()) status = depth_list_.open(folder / "depth.txt", "# timestamp filename");
  return status;
}

Status TumWriter::open(const fs::path& folder, const CameraModel& camera, double depth_units_per_metre) {
  Calibration calibration;
  calibration.camera = camera;
  calibration.depth_units_per_metre = depth_units_per_metre;
  calibration.depth_scale_given = true;
  calibration.readout_given = camera.readout_s != 0;
  return open(folder, calibration);
}

Status TumWriter::write(const RgbdFrame& frame, const Se3* T_world_camera) {
  const std::string colour_stamp = format_stamp(frame.stamp_ns);
  const std::string depth_stamp = format_stamp(frame.depth_stamp_ns);
  const std::string colour_file = "rgb/" + colour_stamp + ".png";
  const std::string depth_file = "depth/" + depth_stamp + ".png";
  Status status = write_png(folder_ / colour_file, frame.colour);
  if (status.ok()) status = write_png(folder_ / depth_file, frame.depth);
  if (status.ok()) status = colour_list_.write(colour_stamp + ' ' + colour_file);
  if (status.ok()) status = depth_list_.write(depth_stamp + ' ' + depth_file);
  if (!status.ok() || T_world_camera == nullptr) return status;
  if (!ground_truth_.is_open()) {
    status = ground_truth_.open(folder_ / "groundtruth.txt");
    if (status.ok()) status = ground_truth_.write(kTrajectoryHeader);
  }
  if (status.ok()) status = ground_truth_.write(trajectory_line(frame.stamp_ns, *T_world_camera));
  return status;
}

}  // namespace plvo
