// SPDX-License-Identifier: Apache-2.0
// plvo simulate: the recording of a camera that moves through a simulated room, with exact ground truth.
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>

#include "plvo/cli/common/console.hpp"
#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/file_roles.hpp"
#include "plvo/cli/common/interrupt.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/simulator_arguments.hpp"
#include "plvo/host/printable.hpp"
#include "plvo/host/standard_streams.hpp"
#include "plvo/replay/imu_files.hpp"
#include "plvo/replay/wheel_files.hpp"
#include "plvo/simulator/simulated_camera.hpp"
#include "plvo/simulator/tum_folder.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kSimulateHelp =
    "Examples:\n"
    "  plvo simulate --out sequence                               then: plvo run sequence\n"
    "  plvo simulate --out dim --scene hall --light varying       a harder one\n";

struct SimulateOptions {
  SimulatorArguments simulator;
  int frames = kSimulatedFrames;
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
  Console console(options.quiet);
  int written = 0;
  status = write_tum_folder(*camera, options.folder, [&](int done, int total) {
    written = done;
    if (console.wants_line()) console.show_line(fmt::format("frame {}/{}", done, total));
    return !interrupted();
  });
  console.clear();
  if (status.ok() && !options.quiet)
    status = print(fmt::format("{0} frames in {1}{2}; next: plvo run {1}\n", written,
                               printable(options.folder), interrupted() ? " (interrupted)" : ""));
  return status.ok() ? kExitSuccess : fail(status);
}

void check(const SimulateOptions& options) {
  FileRoles files;
  for (const char* name : {"rgb.txt", "depth.txt", "calibration.txt", "groundtruth.txt", kGyroFile,
                           kAccelerometerFile, kWheelFile})
    files.writes("--out", std::filesystem::path(options.folder) / name);
  files.reads(options.simulator.trajectory);
  files.check();
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App& command =
      add_command(app, "simulate", "Write a simulated sequence as a TUM folder", kSimulateHelp);
  OptionGroup group(command);
  require(group.path("--out", options->folder, "A new folder for the sequence", "DIR"));
  group.whole("--frames", options->frames, 1, kMostSimulatedFrames,
              "Only the first N frames (default " + std::to_string(kSimulatedFrames) + ")");
  group.flag("--quiet", options->quiet, "Warnings and errors only: no progress, no summary");
  add_simulator_options(command, options->simulator);
  on_command(command, exit_code, [options] {
    check(*options);
    return simulate_command(*options);
  });
}

}  // namespace plvo::cli
