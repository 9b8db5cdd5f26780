// SPDX-License-Identifier: Apache-2.0
// The sequences of the accuracy gate, held in memory: each is tracked several times.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plvo/camera/camera_model.hpp"
#include "plvo/eval/evaluation.hpp"
#include "plvo/host/frame_copy.hpp"

namespace plvo::accuracy {

struct Sequence {
  std::string name;
  CameraModel camera;
  std::vector<FrameCopy> frames;
  eval::Trajectory truth;
  eval::EvaluationOptions evaluation;  // how good the truth is
};

// A recorded sequence: a folder, and the name of a built-in calibration, or nothing for the calibration file
// in the folder.
struct Recorded {
  const char* folder;
  const char* camera_model;
  // Standard deviations of the true poses by motion capture: of the position in each axis, and of the
  // rotation between the captured body and the camera. Zero: the truth is exact.
  double truth_sigma_m, truth_sigma_deg;
};
const std::vector<Recorded>& recorded_sequences();
Status load(const std::filesystem::path& data, const Recorded& recorded, Sequence& sequence);

// The simulator's five scenes under both lights, with its default hand and sensor.
struct Rendered {
  std::string scene, light;
};
std::vector<Rendered> rendered_sequences();
Status render(const Rendered& rendered, Sequence& sequence);

}  // namespace plvo::accuracy
