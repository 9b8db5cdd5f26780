// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/simulator_arguments.hpp"

#include <charconv>

namespace plvo::cli {
namespace {

bool parse_size(std::string_view text, int& width, int& height) {
  const char* end = text.data() + text.size();
  const auto [x, first_error] = std::from_chars(text.data(), end, width);
  if (first_error != std::errc() || x == end || *x != 'x') return false;
  const auto [stop, second_error] = std::from_chars(x + 1, end, height);
  return second_error == std::errc() && stop == end && width >= 64 && height >= 48 && width <= 4096 &&
         height <= 4096;
}

std::string check_size(const std::string& text) {
  int width = 0, height = 0;
  return parse_size(text, width, height)
             ? ""
             : "expected WIDTHxHEIGHT from 64x48 to 4096x4096, such as 320x240: " + text;
}

}  // namespace

void add_simulator_options(CLI::App& command, SimulatorArguments& arguments) {
  const std::string group = "Simulated camera";
  const auto add = [&](const char* name, auto& value, const char* what, const char* type) {
    return command.add_option(name, value, what)->type_name(type)->group(group);
  };
  add("--scene", arguments.scene, "Room: corridor, staircase, hall, desk, bare (default corridor)", "NAME");
  add("--light", arguments.light, "constant, or varying: a lamp that swings and dims", "NAME");
  add("--seed", arguments.seed, "Another room, walk and noise of the same kind", "NUMBER");
  add("--fps", arguments.fps, "Frames per second (default 30)", "NUMBER");
  add("--size", arguments.size, "Image size in pixels (default 640x480)", "WxH")
      ->check(CLI::Validator(check_size, ""));
  add("--rolling-shutter", arguments.readout_s,
      "Seconds from the first row to the last (default 0: all rows at once; a Kinect's: 0.0261)", "SECONDS");
  add("--depth-delay", arguments.depth_timing.delay_s,
      "Depth is exposed this long after its stamp (default 0; negative: before)", "SECONDS");
  add("--depth-readout", arguments.depth_timing.readout_s,
      "Seconds from the first row of depth to the last (default: --rolling-shutter)", "SECONDS");
  add("--depth-stamp-offset", arguments.depth_timing.stamp_offset_s,
      "Depth is stamped, and taken, this long after colour: at most half a frame (default 0)", "SECONDS");
  add("--depth-fps", arguments.depth_timing.fps,
      "Depth images per second on a clock of their own, at least --fps (default: the colour's clock)",
      "NUMBER");
  add("--depth-stamp-jitter", arguments.depth_timing.stamp_jitter_s,
      "Standard deviation of depth's stamps; the exposures keep their time (default 0)", "SECONDS");
  add("--depth-scale-error", arguments.depth_scale_error, "Reported depth over true depth (default 1)",
      "FACTOR");
  add("--trajectory", arguments.trajectory,
      "TUM ground truth that moves the camera instead of the seeded hand", "FILE");
  add("--threads", arguments.threads, "Of the rendering; the images do not depend on it (default 2)",
      "NUMBER");
  command.add_flag("--clean", arguments.clean, "No noise, no blur: the exact twin of the same walk")
      ->group(group);
}

Status make_simulator_options(const SimulatorArguments& arguments, int frames, SimulatorOptions& options) {
  if (Status status = parse_scene(arguments.scene, options.scene); !status.ok()) return status;
  if (Status status = parse_light(arguments.light, options.light); !status.ok()) return status;
  options.seed = arguments.seed;
  options.frames = frames;
  options.fps = arguments.fps;
  options.noise = !arguments.clean;
  options.trajectory_file = arguments.trajectory;
  options.threads = arguments.threads;
  options.camera.readout_s = arguments.readout_s;
  options.depth_timing = arguments.depth_timing;
  options.depth.scale_error = arguments.depth_scale_error;
  int width = 0, height = 0;
  if (!arguments.size.empty() && parse_size(arguments.size, width, height)) {
    CameraModel& camera = options.camera;
    const double scale = static_cast<double>(width) / camera.width;
    camera.pinhole.fx *= scale;
    camera.pinhole.fy *= scale;
    camera.pinhole.cx = (width - 1) / 2.0;
    camera.pinhole.cy = (height - 1) / 2.0;
    camera.width = width;
    camera.height = height;
  }
  return options.validate();
}

}  // namespace plvo::cli
