// SPDX-License-Identifier: Apache-2.0
// plvo live: a sensor in, poses out, while it happens.
#include <memory>
#include <string>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/live/live_session.hpp"
#include "plvo/view/host_names.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kHelp =
    "Examples:\n"
    "  plvo live --view 8080                      look at http://127.0.0.1:8080/ meanwhile\n"
    "  plvo live --out poses.txt --record walk    keep the poses and the images\n"
    "  plvo live --stream - | your_program        poses as JSON, one line a frame\n"
    "  plvo live --device walk.oni --out t.txt    a recording, every frame of it\n"
    "\n"
    "An unplugged or silent sensor is waited for; Ctrl-C ends, with whole files. No sensor? plvo doctor.\n"
    "\n";

void add_outputs(CLI::App& command, LiveOptions& options) {
  const std::string group = "Outputs (docs/formats.md)";
  const auto file = [&](const char* name, std::string& path, const char* what) {
    command.add_option(name, path, what)->type_name("FILE")->group(group);
  };
  file("--out", options.outputs.files.trajectory, "Trajectory, TUM format: one line per tracked frame");
  file("--covariance", options.outputs.files.covariance, "6x6 covariance of each pose");
  file("--motions", options.outputs.files.motions,
       "Motion from the reference of each frame, with its 6x6 covariance");
  file("--stats", options.outputs.files.stats, "CSV: one row per frame, lost ones with the reason");
  file("--json", options.summary, "The summary as JSON");
  command
      .add_option("--record", options.record,
                  "Keep every captured frame: a new folder that plvo run reads, or a new .oni file")
      ->type_name("DIR|FILE.oni")
      ->group(group);
  command
      .add_option("--view", options.outputs.view,
                  "The live view in a browser; on this machine only, unless an address is given")
      ->type_name("[ADDR:]PORT")
      ->group(group);
  command
      .add_option(
          "--view-host", options.outputs.view_names,
          "A further name under which the live view answers, as it stands in the browser: for a proxy, a "
          "tunnel or robot.local; may be given several times")
      ->type_name("NAME[:PORT]")
      ->allow_extra_args(false)
      ->check(CLI::Validator(
          [](const std::string& name) {
            return HostNames::is_valid(name)
                       ? ""
                       : "expected a NAME or NAME:PORT as in http://NAME:PORT/: " + name;
          },
          ""))
      ->needs("--view")
      ->group(group);
  command
      .add_option(
          "--stream", options.outputs.streams,
          "Poses as JSON lines, over TCP, a Unix socket or standard output; may be given several times")
      ->type_name("[ADDR:]PORT|unix:PATH|-")
      ->allow_extra_args(false)
      ->group(group);
  command.add_flag("--quiet", options.quiet, "No progress line and no summary; warnings remain")
      ->group(group);
}

}  // namespace

void add_live(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<LiveOptions>();
  CLI::App* command = app.add_subcommand("live", "Track what a sensor sees, now");
  add_live_camera_options(*command, options->camera);
  command->add_option("--rate", options->rate_hz, "Frames a second that are tracked, at most")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("HZ");
  command->add_flag("--every-frame", options->every_frame,
                    "The camera waits for the odometry: no frame is dropped here (.oni files always do)");
  command->add_option("--frames", options->frames, "End after so many tracked or lost frames")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  command->add_option("--seconds", options->seconds, "End after so long")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("SECONDS");
  add_outputs(*command, *options);
  add_odometry_options(*command, options->odometry);
  command->footer(std::string(kHelp) + kExitCodeHelp);
  command->callback([options, &exit_code] { exit_code = LiveSession(*options).run(); });
}

}  // namespace plvo::cli
