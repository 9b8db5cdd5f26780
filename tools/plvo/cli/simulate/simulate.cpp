// SPDX-License-Identifier: Apache-2.0
// plvo simulate: a recording of a walk through a room that does not exist, with exact ground truth.
#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/interrupt.hpp"
#include "plvo/cli/common/simulator_arguments.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/simulator/simulated_camera.hpp"
#include "plvo/simulator/tum_folder.hpp"

namespace plvo::cli {
namespace {

struct SimulateOptions {
  SimulatorArguments simulator;
  int frames = 300;
  std::string folder;
  bool quiet = false;
};

int simulate_command(const SimulateOptions& options) {
  SimulatorOptions settings;
  std::unique_ptr<SimulatedCamera> camera;
  Status status = make_simulator_options(options.simulator, options.frames, settings);
  if (status.ok()) status = SimulatedCamera::create(settings, camera);
  if (!status.ok()) return fail(status);
  catch_interrupt();
  const bool progress = !options.quiet && isatty(STDERR_FILENO) == 1;
  int written = 0;
  status = write_tum_folder(*camera, options.folder, [&](int done, int total) {
    written = done;
    if (progress) fmt::print(stderr, "\r\033[Kframe {}/{}", done, total);
    return !interrupted();
  });
  if (progress) fmt::print(stderr, "\r\033[K");
  if (!status.ok()) return fail(status);
  if (!options.quiet) {
    fmt::print("{} frames in {}{}; next: plvo run {}\n", written, options.folder,
               interrupted() ? " (interrupted)" : "", options.folder);
  }
  return kExitSuccess;
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = app.add_subcommand("simulate", "Write a simulated sequence as a TUM folder");
  command->add_option("--out", options->folder, "Folder to write")->required()->type_name("DIR");
  command->add_option("--frames", options->frames, "How many (default 300)")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  command->add_flag("--quiet", options->quiet, "No progress line");
  add_simulator_options(*command, options->simulator);
  command->footer(kExitCodeHelp);
  command->callback([options, &exit_code] { exit_code = simulate_command(*options); });
}

}  // namespace plvo::cli
