// SPDX-License-Identifier: Apache-2.0
// Views of a recorded sequence with their depth and true poses. The true edges are unknown.
#include <fmt/core.h>

#include "plvo/bench/detectors/view.hpp"
#include "plvo/bench/systems/ideal_images.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/image/gray.hpp"
#include "plvo/replay/calibration/sequence_calibration.hpp"
#include "plvo/replay/recorded_camera.hpp"

namespace plvo::bench {
namespace {

View make_view(IdealImages& images, const RgbdFrame& frame) {
  images.make(frame);
  View view;
  view.width = images.width();
  view.height = images.height();
  const std::size_t pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  view.grey.resize(pixels);
  to_gray({images.rgb(), view.width, view.height, static_cast<std::ptrdiff_t>(view.width) * 3,
           PixelFormat::kRgb8},
          {view.grey.data(), view.width, view.height, view.width});
  for (std::size_t i = 0; i < pixels; ++i)
    view.depth_m.push_back(static_cast<float>(images.depth()[i] * frame.depth.metres_per_unit));
  return view;
}

}  // namespace

Status read_views(const NamedFolder& folder, const JobOptions& options, ViewSequence& sequence) {
  const std::string& model = folder.camera_model.empty() ? options.camera_model : folder.camera_model;
  Calibration calibration;
  std::string guess;
  if (Status status = model.empty() ? sequence_calibration(folder.folder, calibration, guess)
                                    : builtin_calibration(model, calibration);
      !status.ok())
    return status;
  SequenceOptions range;
  if (options.frames > 0) range.end_frame = options.frames;
  RecordedCamera camera;
  if (Status status = camera.open(folder.folder, calibration, range); !status.ok()) return status;
  eval::Trajectory truth;
  if (Status status = eval::read_trajectory({folder.folder / "groundtruth.txt", {}, {}}, truth); !status.ok())
    return status;
  sequence.name = folder.sequence;
  sequence.pinhole = camera.model().pinhole;
  IdealImages images(camera.model());
  for (RgbdFrame frame;;) {
    const Status status = camera.next(frame);
    if (status.code() == StatusCode::kEndOfStream) break;
    if (status.code() == StatusCode::kDamaged) continue;
    if (!status.ok()) return status;
    const eval::SampledPoses pose = eval::sample(truth, {frame.stamp_ns}, {.method = options.sampling});
    if (!pose.valid[0]) continue;
    sequence.views.push_back(make_view(images, frame));
    sequence.views.back().T_world_camera = pose.poses[0];
  }
  return {};
}

}  // namespace plvo::bench
