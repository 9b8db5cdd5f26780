// SPDX-License-Identifier: Apache-2.0
// Writes frames as a TUM folder that TumCamera reads back: rgb/, depth/, rgb.txt, depth.txt, calibration.txt,
// and groundtruth.txt when poses are known. A frame is listed only after its two images are on the disk.
#pragma once

#include <filesystem>

#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/host/line_file.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/math/se3.hpp"

namespace plvo {

class TumWriter {
 public:
  // Makes the folder (its parent must exist). depth_units_per_metre: what the frames' depth is in. kIo with
  // the operating system's reason.
  Status open(const std::filesystem::path& folder, const CameraModel& camera, double depth_units_per_metre);
  // T_world_camera may be null: then groundtruth.txt gets no line.
  Status write(const RgbdFrame& frame, const Se3* T_world_camera = nullptr);

 private:
  std::filesystem::path folder_;
  LineFile colour_list_, depth_list_, ground_truth_;
};

}  // namespace plvo
