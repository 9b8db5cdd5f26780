// SPDX-License-Identifier: Apache-2.0
// Which camera the frames come from, and how it is calibrated: the options that say so, and what they open.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plvo/cli/common/simulator_arguments.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/replay/calibration.hpp"

namespace plvo::cli {

struct CalibrationOptions {
  std::string file, model_name;
  std::optional<double> fx, fy, cx, cy, depth_scale, readout_s;
  std::vector<double> distortion;  // k1 k2 p1 p2 [k3]
};
// group: what the help calls them. The depth scale is asked for only where it is not the camera's own.
enum class DepthScale : std::uint8_t { kAsked, kFromCamera };
void add_calibration_options(CLI::App& command, CalibrationOptions& options, const std::string& group,
                             DepthScale depth_scale);

// What the flags say; without any, folder/calibration.txt. kInvalidArgument, naming the ways to give one,
// when there is none at all.
Status find_calibration(const CalibrationOptions& options, const std::filesystem::path& folder,
                        Calibration& calibration);

struct FrameRange {
  std::size_t first = 0;
  std::size_t end = std::numeric_limits<std::size_t>::max();  // exclusive
};
// "a:b", "a:", ":b": frames a … b-1.
bool parse_frame_range(const std::string& text, FrameRange& range);

struct CameraOptions {
  std::string kind;  // "sim", or empty for a recorded folder
  std::string folder;
  std::string frames;
  std::string associations;
  double tolerance_s = 0.02;
  CalibrationOptions calibration;
  SimulatorArguments simulator;
};
// The command must name a folder or a camera: anything else is a usage error.
void add_camera_options(CLI::App& command, CameraOptions& options);

struct OpenedCamera {
  std::shared_ptr<RgbdCamera> camera;      // not unique: it deletes the class that it was made with
  std::string name;                        // for people
  std::optional<std::size_t> frame_count;  // where it is known
  std::size_t unpaired_images = 0;         // colour images without depth
  // The true poses, where there are any: from a file beside the images, or from the simulator at these
  // stamps.
  std::function<Status(const std::vector<std::int64_t>& stamps_ns, eval::Trajectory& truth)> ground_truth;
};
Status open_camera(const CameraOptions& options, OpenedCamera& opened);

}  // namespace plvo::cli
