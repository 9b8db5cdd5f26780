// SPDX-License-Identifier: Apache-2.0
// Writes frames as a TUM folder that RecordedCamera reads back: rgb/, depth/, rgb.txt, depth.txt,
// calibration.txt, and groundtruth.txt when poses are known. A frame is listed only after its two images are
// on the disk, so that a full disk or an interruption leaves a folder that can be read up to there.
#pragma once

#include <filesystem>

#include "plvo/base/status.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/replay/calibration/calibration.hpp"

namespace plvo {

class TumWriter {
 public:
  // Makes the folder and those above it. The calibration's depth scale is the unit of the frames' depth; its
  // readout_given says whether the readout is known. kInvalidArgument when the folder holds a recording
  // already; kIo with the operating system's reason.
  Status open(const std::filesystem::path& folder, const Calibration& calibration);
  // The same for a camera whose readout is known when it is not 0.
  Status open(const std::filesystem::path& folder, const CameraModel& camera, double depth_units_per_metre);
  // T_world_camera may be null: then groundtruth.txt gets no line.
  Status write(const RgbdFrame& frame, const Se3* T_world_camera = nullptr);

 private:
  std::filesystem::path folder_;
  LineFile colour_list_, depth_list_, ground_truth_;
};

}  // namespace plvo
