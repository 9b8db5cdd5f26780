// SPDX-License-Identifier: Apache-2.0
// plvo live: a sensor in, poses out, while it happens.
#include <algorithm>
#include <memory>
#include <string>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/file_roles.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/live/live_session.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/bag_options.hpp"
#include "plvo/host/stream/tcp_listener.hpp"
#include "plvo/replay/imu_files.hpp"
#include "plvo/view/host_names.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kLiveHelp =
    "Examples:\n"
    "  plvo live --view 8080                      look at http://127.0.0.1:8080/ meanwhile\n"
    "  plvo live --out poses.txt --record sequence   keep the poses and the images\n"
    "  plvo live --stream - | your_program        poses as JSON, one line a frame\n"
    "  plvo live --device recording.oni --out t.txt   a recording, every frame of it; recording.bag, too\n"
    "  plvo live --camera sim --size 320x240 --view 8080    no sensor needed\n"
    "  plvo live --map 256 --map-in home.map --map-out home.map    a map that grows from day to day\n"
    "  plvo live --imu                            a Kinect's accelerometer holds roll and pitch\n"
    "  your_robot | plvo live --wheels - --base-camera 0.2 0 0.5 -0.5 0.5 -0.5 0.5    with its wheels\n"
    "\n"
    "An unplugged or silent sensor is waited for; Ctrl-C ends, with whole files. No sensor? plvo doctor.\n";

// An address is judged before a sensor is opened for it.
std::string check_address(const std::string& text) {
  std::string host;
  int port = 0;
  return split_address(text, host, port) ? ""
                                         : expected("[ADDRESS:]PORT, such as 8080 or 127.0.0.1:8080", text);
}

std::string check_stream(const std::string& text) {
  constexpr std::size_t kLongestPath = 107;  // of a Unix socket
  if (text == "-") return {};
  if (text.rfind("unix:", 0) == 0) {
    const std::size_t length = text.size() - 5;
    return length > 0 && length <= kLongestPath ? ""
                                                : expected("unix: and a path of 1 to 107 characters", text);
  }
  return check_address(text).empty() ? "" : expected("[ADDRESS:]PORT, unix:PATH or -", text);
}

void add_outputs(CLI::App& command, LiveOptions& options) {
  add_output_options(command, options.outputs.files);
  OptionGroup group(command, kOutputGroup);
  add_level_option(group, options.outputs.files.base);
  group.path("--json", options.summary, "The summary as JSON");
  group.path("--record", options.record,
             "Keep every captured frame: in a new folder that plvo run reads, or in a new .oni file",
             "DIR|FILE.oni");
  group.add("--view", "[ADDR:]PORT",
            "The live view in a browser; for this machine alone, unless an address is given",
            [&options](const std::string& text) {
              options.outputs.view = text;
              return check_address(text);
            });
  repeatable(group.add("--view-host", "NAME[:PORT]",
                       "A further name under which the live view answers, as it stands in the browser: for a "
                       "proxy, a tunnel or robot.local; may be given several times",
                       [&options](const std::string& text) {
                         options.outputs.view_names.push_back(text);
                         return HostNames::is_valid(text)
                                    ? ""
                                    : expected("a NAME or NAME:PORT as in http://NAME:PORT/", text);
                       }));
  repeatable(
      group.add("--stream", "[ADDR:]PORT|unix:PATH|-",
                "Poses as JSON lines, over TCP, a Unix socket or standard output; may be given several times",
                [&options](const std::string& text) {
                  options.outputs.streams.push_back(text);
                  return check_stream(text);
                }));
  group.flag("--quiet", options.quiet, "Warnings and errors only: no progress, no summary");
}

void check(const CLI::App& command, LiveOptions& options) {
  check_live_camera_options(command, options.camera);
  check_odometry_options(options.odometry);
  if (is_played(options.camera)) {
    refuse_options(command, {"--every-frame"},
                   "is what a recording and the simulated camera do anyway; leave it out");
    refuse_options(command, {"--imu"},
                   "is for a live Kinect; plvo run FILE.bag --imu takes a bag's readings");
  }
  if ((is_bag(options.camera.device) || options.camera.simulated) && is_oni_file(options.record))
    refuse("--record", "a ROS bag and the simulated camera are kept as a folder, not as an .oni file");
  if (options.outputs.view.empty())
    refuse_options(command, {"--view-host"}, "is for the live view: add --view PORT, or leave it out");
  LiveOutputOptions& outputs = options.outputs;
  check_output_options(command);
  const bool wheels = !options.wheels.file.empty();
  check_base_option(outputs.files.base, outputs.files.has_poses() || !outputs.streams.empty() || wheels);
  check_wheel_options(command, options.wheels, outputs.files.base);
  check_level_option(command, options.imu);
  check_map_options(command, options.map);
  options.odometry.level_world = outputs.files.base.level;
  FileRoles files;
  files.reads(options.odometry.mask);
  for (const auto& [option, path] : options.outputs.files.named()) files.writes(option, path);
  files.writes("--json", options.summary);
  if (is_oni_file(options.record)) files.writes("--record", options.record);
  if (options.imu && !is_oni_file(options.record) && !options.record.empty())
    files.writes("--record", std::filesystem::path(options.record) / kAccelerometerFile);
  if (options.wheels.file != "-") files.reads(options.wheels.file);
  if (wheels && !is_oni_file(options.record) && !options.record.empty())
    files.writes("--record", std::filesystem::path(options.record) / kWheelFile);
  for (const std::string& stream : options.outputs.streams)
    if (stream == "-") files.writes("--stream", stream);
  add_map_files(options.map, files);
  add_inputs(options.camera, files);
  files.check();
}

}  // namespace

void add_live(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<LiveOptions>();
  CLI::App& command = add_command(app, "live", "Track what a sensor sees, now", kLiveHelp);
  add_live_camera_options(command, options->camera, PlayedFiles::kOniAndBags);
  add_played_camera_options(command, options->camera);
  OptionGroup group(command);
  group.flag(
      "--imu", options->imu,
      "With a Kinect v1's accelerometer: gravity holds roll and pitch; with --record DIR it is kept, too");
  group.number("--max-rate", options->max_rate_hz, positive(1000), "HZ",
               "Largest number of frames tracked per second");
  group.flag("--every-frame", options->every_frame, "Drop no frame: the camera waits for the odometry");
  add_wheel_options(command, options->wheels, WheelSource::kStream);
  add_limit_options(command, options->frames, options->seconds);
  add_bag_options(command, options->camera.topics, BagImu::kPassedOver);
  add_map_options(command, options->map);
  add_outputs(command, *options);
  add_odometry_options(command, options->odometry);
  on_command(command, exit_code, [&command, options] {
    check(command, *options);
    if (given(command, "--frames"))
      options->camera.simulated_frames =
          static_cast<int>(std::min<std::uint64_t>(options->frames, kMostSimulatedFrames));
    return LiveSession(*options).run();
  });
}

}  // namespace plvo::cli
