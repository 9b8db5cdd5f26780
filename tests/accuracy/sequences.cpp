// SPDX-License-Identifier: Apache-2.0
#include "sequences.hpp"

#include <memory>
#include <numbers>

#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/replay/calibration/sequence_calibration.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "plvo/simulator/simulated_camera.hpp"

namespace plvo::accuracy {
namespace {

constexpr int kRenderedFrames = 60;  // 2 s

Status keep_frames(RgbdCamera& camera, Sequence& sequence) {
  sequence.camera = camera.model();
  for (RgbdFrame frame;;) {
    const Status status = camera.next(frame);
    if (status.code() == StatusCode::kEndOfStream) return {};
    if (!status.ok()) return status;
    sequence.frames.emplace_back().assign(frame);
  }
}

}  // namespace

// The truth's own noise as docs/decisions/truth_noise.md has measured it.
const std::vector<Recorded>& recorded_sequences() {
  static const std::vector<Recorded> sequences = {
      {"fr1_rpy_150", "tum-fr1", 0.0004, 0.102}, {"fr3_notexture_120", "tum-fr3", 0.0003, 0.2},
      {"corridor_constant", "", 0, 0},           {"corridor_varying", "", 0, 0},
      {"realsense_shelf_50", "", 0, 0},
  };
  return sequences;
}

Status load(const std::filesystem::path& data, const Recorded& recorded, Sequence& sequence) {
  const std::filesystem::path folder = data / recorded.folder;
  sequence = {};
  sequence.name = recorded.folder;
  sequence.evaluation.truth_sigma = {recorded.truth_sigma_m,
                                     recorded.truth_sigma_deg * std::numbers::pi / 180};
  sequence.evaluation.fit_truth = recorded.truth_sigma_m > 0;
  Calibration calibration;
  std::string guess;
  const std::string model = recorded.camera_model;
  if (Status status = model.empty() ? sequence_calibration(folder, calibration, guess)
                                    : builtin_calibration(model, calibration);
      !status.ok())
    return status;
  RecordedCamera camera;
  if (Status status = camera.open(folder, calibration); !status.ok()) return status;
  if (Status status = read_ground_truth(folder, {}, sequence.truth); !status.ok()) return status;
  return keep_frames(camera, sequence);
}

std::vector<Rendered> rendered_sequences() {
  std::vector<Rendered> sequences;
  for (const SceneName scene :
       {SceneName::kCorridor, SceneName::kStaircase, SceneName::kHall, SceneName::kDesk, SceneName::kBare})
    for (const LightName light : {LightName::kConstant, LightName::kVarying})
      sequences.push_back({to_string(scene), to_string(light)});
  return sequences;
}

Status render(const Rendered& rendered, Sequence& sequence) {
  SimulatorOptions options;
  options.frames = kRenderedFrames;
  if (Status status = parse_scene(rendered.scene, options.scene); !status.ok()) return status;
  // Rendering takes most of the time, so the images have a quarter of the recorded ones' pixels. A small
  // image of the hall shows too few features under the swinging lamp.
  if (options.scene != SceneName::kHall) {
    options.camera.width = 320;
    options.camera.height = 240;
    options.camera.pinhole = {262.5, 262.5, 159.5, 119.5};
  }
  if (Status status = parse_light(rendered.light, options.light); !status.ok()) return status;
  std::unique_ptr<SimulatedCamera> camera;
  if (Status status = SimulatedCamera::create(options, camera); !status.ok()) return status;
  sequence = {};
  sequence.name = rendered.scene + '_' + rendered.light;
  for (int i = 0; i < camera->frames(); ++i)
    sequence.truth.poses.push_back({camera->stamp_ns(i), camera->pose(i)});
  return keep_frames(*camera, sequence);
}

}  // namespace plvo::accuracy
