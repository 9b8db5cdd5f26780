// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/options/simulator_arguments.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "plvo/camera/camera_model.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/host/number_text.hpp"
#include "plvo/odometry/config.hpp"

namespace plvo::cli {
namespace {

// Two whole numbers with this sign between them.
bool parse_pair(std::string_view text, char sign, int& first, int& second) {
  const std::size_t place = text.find(sign);
  return place != std::string_view::npos && parse_whole_text(text.substr(0, place), first) &&
         parse_whole_text(text.substr(place + 1), second);
}

bool parse_size(std::string_view text, int& width, int& height) {
  return parse_pair(text, 'x', width, height) && width >= Limits::kLeastSide &&
         height >= Limits::kLeastSide && width <= Limits::kMostSide && height <= Limits::kMostSide;
}

bool parse_range(std::string_view text, int& first, int& end) {
  return parse_pair(text, ':', first, end) && first >= 0 && first < end && end <= kMostSimulatedFrames;
}

// Names as the simulator writes them.
template <typename Name, std::size_t N>
std::vector<std::pair<std::string, Name>> names_of(const Name (&values)[N]) {
  std::vector<std::pair<std::string, Name>> names;
  for (const Name value : values) names.emplace_back(to_string(value), value);
  return names;
}

}  // namespace

void add_simulator_options(CLI::App& command, SimulatorArguments& arguments) {
  OptionGroup group(command, kSimulatorGroup);
  group.choice("--scene", arguments.scene,
               names_of({SceneName::kCorridor, SceneName::kStaircase, SceneName::kHall, SceneName::kDesk,
                         SceneName::kBare}),
               "Room through which the camera moves (default corridor)");
  group.choice("--light", arguments.light, names_of({LightName::kConstant, LightName::kVarying}),
               "varying: a lamp that swings and dims (default constant)");
  group.whole("--seed", arguments.seed, 0, UINT64_MAX,
              "Another room, trajectory and noise of the same kind (default 1)");
  group.whole(
      "--storey", arguments.storey, 0, UINT32_MAX,
      "Another room of the same plan and paint, with the same trajectory, with grain, wear and prints of its "
      "own: it looks alike (default 0)");
  group.number("--fps", arguments.fps, {1, 1000}, "HZ", "Frames per second (default 30)");
  group.add("--size", "WIDTHxHEIGHT", "Image size in pixels (default 640x480)",
            [&arguments](const std::string& text) -> std::string {
              if (parse_size(text, arguments.width, arguments.height)) return {};
              return expected(fmt::format("WIDTHxHEIGHT from {0}x{0} to {1}x{1}, such as 320x240",
                                          Limits::kLeastSide, Limits::kMostSide),
                              text);
            });
  group.number(
      "--rolling-shutter", arguments.readout_s, {0, 1}, "SECONDS",
      fmt::format("Time from the first row to the last (default 0: all rows at once; a Kinect's: {})",
                  kKinectReadout_s));
  group.number("--depth-delay", arguments.depth_schedule.delay_s, {-0.1, 0.1}, "SECONDS",
               "Depth is exposed this long after its stamp (default 0; negative: before)");
  group.number("--depth-readout", arguments.depth_schedule.readout_s, {0, 0.1}, "SECONDS",
               "Time from the first row of depth to the last (default: --rolling-shutter)");
  group.number("--depth-stamp-offset", arguments.depth_schedule.stamp_offset_s, {-0.5, 0.5}, "SECONDS",
               "Depth is stamped, and taken, this long after colour: at most half a frame (default 0)");
  group.number(
      "--depth-fps", arguments.depth_schedule.fps, {1, 1000}, "HZ",
      "Depth images per second on a clock of their own, at least --fps (default: the colour's clock)");
  group.number("--depth-stamp-jitter", arguments.depth_schedule.stamp_jitter_s, {0, 0.1}, "SECONDS",
               "Standard deviation of depth's stamps; the exposures keep their time (default 0)");
  group.number("--depth-scale-error", arguments.depth_scale_error, {0.5, 2}, "FACTOR",
               "Reported depth over true depth (default 1)");
  group.add("--covered", "FIRST:END", "A hand over the lens from frame FIRST to before END: black, no depth",
            [&arguments](const std::string& text) -> std::string {
              if (parse_range(text, arguments.covered_first, arguments.covered_end)) return {};
              return expected("a range of frames such as 100:115", text);
            });
  group.add("--with", "NAME,...",
            fmt::format("Adds one or several difficulties, separated by commas: {}",
                        fmt::join(difficulty_names(), ", ")),
            [&arguments](const std::string& text) -> std::string {
              for (const std::string& name : CLI::detail::split(text, ','))
                if (!add_difficulty(name, arguments.difficulties).ok())
                  return expected(fmt::format("names out of {}, separated by commas",
                                              fmt::join(difficulty_names(), ", ")),
                                  name);
              return {};
            });
  group.flag("--still", arguments.still, "The camera stays at its first pose");
  group.flag("--robot", arguments.robot,
             "The camera stands level on a robot, 0.2 m ahead of its base and 0.5 m above it (--base-camera "
             "0.2 0 0.5 "
             "-0.5 0.5 -0.5 0.5); plvo simulate writes its wheel_odometry.txt, too");
  group.path("--trajectory", arguments.trajectory,
             "TUM trajectory along which the camera moves, instead of the seeded one");
  group.whole("--threads", arguments.threads, 1, 256,
              "Threads of the rendering; the images do not depend on it (default 2)");
  group.flag("--clean", arguments.clean, "No noise, no blur: the exact twin of the same sequence");
}

Status make_simulator_options(const SimulatorArguments& arguments, int frames, SimulatorOptions& options) {
  options.scene = arguments.scene;
  options.light = arguments.light;
  options.seed = arguments.seed;
  options.storey = arguments.storey;
  options.frames = frames;
  options.fps = arguments.fps;
  options.noise = !arguments.clean;
  options.trajectory_file = arguments.trajectory;
  options.threads = arguments.threads;
  CameraModel& camera = options.camera;
  camera.readout_s = arguments.readout_s;
  options.depth_schedule = arguments.depth_schedule;
  options.depth.scale_error = arguments.depth_scale_error;
  options.difficulties = arguments.difficulties;
  options.still = arguments.still;
  options.robot = arguments.robot;
  options.covered_first = arguments.covered_first;
  options.covered_end = arguments.covered_end;
  if (arguments.width > 0) {
    const double scale = static_cast<double>(arguments.width) / camera.width;
    camera.pinhole.fx *= scale;
    camera.pinhole.fy *= scale;
    camera.pinhole.cx = (arguments.width - 1) / 2.0;
    camera.pinhole.cy = (arguments.height - 1) / 2.0;
    camera.width = arguments.width;
    camera.height = arguments.height;
  }
  return options.validate();
}

}  // namespace plvo::cli
