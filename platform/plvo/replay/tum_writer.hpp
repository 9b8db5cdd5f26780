// SPDX-License-Identifier: Apache-2.0
// Writes frames as a TUM folder that RecordedCamera can read: rgb/, depth/, rgb.txt, depth.txt,
// calibration.txt, and groundtruth.txt if poses are known. A frame is listed only after its two images are on
// the disk. So after a full disk or an interruption, the folder can be read up to that point.
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
  // Creates the folder and its parents. The calibration's depth scale is the unit of the frames' depth; its
  // readout_given states whether the readout is known. Returns kInvalidArgument if the folder already holds a
  // recording; kIo with the operating system's reason.
  Status open(const std::filesystem::path& folder, const Calibration& calibration);
  // Does the same for a camera whose readout is known if it is not 0.
  Status open(const std::filesystem::path& folder, const CameraModel& camera, double depth_units_per_metre);
  // T_world_camera may be null: then groundtruth.txt gets no line.
  Status write(const RgbdFrame& frame, const Se3* T_world_camera = nullptr);

 private:
  std::filesystem::path folder_;
  LineFile colour_list_, depth_list_, ground_truth_;
};

}  // namespace plvo
