// SPDX-License-Identifier: Apache-2.0
// Writes the same simulated frames twice: as raw frames for the virtual device and as a TUM folder for
// replay. Depth is rounded to millimetres first, the unit of an OpenNI2 device, so live and replay see the
// same bytes.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "plvo/replay/tum_writer.hpp"
#include "plvo/simulator/simulated_camera.hpp"
#include "raw_frames.hpp"

namespace plvo_test {

inline plvo::Status write_virtual_frames(const plvo::SimulatorOptions& options,
                                         const std::filesystem::path& raw, const std::filesystem::path& tum) {
  std::unique_ptr<plvo::SimulatedCamera> camera;
  if (plvo::Status status = plvo::SimulatedCamera::create(options, camera); !status.ok()) return status;
  const plvo::CameraModel model = camera->model();
  plvo::TumWriter folder;
  if (plvo::Status status = folder.open(tum, model, 1000); !status.ok()) return status;
  RawWriter frames;
  if (!frames.open(raw.c_str(), model.width, model.height))
    return {plvo::StatusCode::kIo, "cannot write raw frames"};
  std::vector<std::uint16_t> millimetres(static_cast<std::size_t>(model.width) *
                                         static_cast<std::size_t>(model.height));
  plvo::RgbdFrame frame;
  plvo::Status status;
  while ((status = camera->next(frame)).ok()) {
    for (int y = 0; y < model.height; ++y) {
      for (int x = 0; x < model.width; ++x) {
        const double mm = frame.depth.data[y * frame.depth.stride + x] * frame.depth.metres_per_unit * 1000;
        millimetres[static_cast<std::size_t>(y * model.width + x)] = static_cast<std::uint16_t>(mm + 0.5);
      }
    }
    frame.depth = {millimetres.data(), model.width, model.height, model.width, 0.001};
    const plvo::Se3 pose = camera->ground_truth(frame.stamp_ns);
    if (plvo::Status written = folder.write(frame, &pose); !written.ok()) return written;
    if (!frames.write(frame)) return {plvo::StatusCode::kIo, "cannot write raw frames"};
  }
  if (status.code() != plvo::StatusCode::kEndOfStream) return status;
  return frames.close() ? plvo::Status() : plvo::Status(plvo::StatusCode::kIo, "cannot write raw frames");
}

}  // namespace plvo_test
