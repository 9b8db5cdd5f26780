// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/run/wheel_options.hpp"

#include <fmt/core.h>

#include <utility>

#include "plvo/cli/options/arguments.hpp"

namespace plvo::cli {
namespace {

// Beyond them a unit is more likely to be wrong than a robot to be that quick.
constexpr double kQuick_mps = 20, kQuick_rps = 10;

}  // namespace

void add_wheel_options(CLI::App& command, WheelOptions& options) {
  OptionGroup group(command);
  group.path("--wheels", options.file,
             "With wheel odometry: 'stamp vx vy wz' per line (m/s, rad/s of the robot's base), or also "
             "'sigma_vx sigma_vy sigma_wz'; --base-camera says where the camera sits");
  group.number(
      "--wheels-error", options.share, {0, 1}, "SHARE",
      fmt::format("Of lines without sigma: how far the wheels are off, as a share of the speed, slip "
                  "included (default {})",
                  WheelConfig().share));
}

void check_wheel_options(const CLI::App& command, const WheelOptions& options, const CameraOptions& camera,
                         const BaseOption& base) {
  if (options.file.empty())
    return refuse_options(command, {"--wheels-error"}, "is for --wheels: add that, or leave this away");
  if (camera.simulated)
    refuse("--wheels", "is for recorded sequences; plvo simulate --robot records wheels, too");
  if (base.numbers.empty())
    refuse("--wheels", "needs --base-camera: where the camera sits in the robot whose wheels these are");
}

Status open_wheels(const WheelOptions& options, const BaseOption& base, Log& log,
                   std::optional<RecordedWheels>& wheels) {
  if (options.file.empty()) return {};
  WheelRecording recording;
  if (Status status = read_wheel_file(options.file, recording); !status.ok()) return status;
  if (recording.ignored > 0)
    log.write(LogLevel::kWarning, fmt::format("{} samples of the wheels left out: not finite, or not later "
                                              "than the one before",
                                              recording.ignored));
  WheelConfig config;
  config.T_base_camera = *base.T_base_camera;
  config.share = options.share;
  if (Status status = wheels.emplace().init(std::move(recording), config); !status.ok()) return status;
  if (wheels->largest_speed() > kQuick_mps)
    log.write(LogLevel::kWarning,
              fmt::format("the wheels drive at up to {:.3g} m/s: are their speeds in m/s?",
                          wheels->largest_speed()));
  if (wheels->largest_turn_rate() > kQuick_rps)
    log.write(LogLevel::kWarning,
              fmt::format("the wheels turn at up to {:.3g} rad/s: are their rates in rad/s?",
                          wheels->largest_turn_rate()));
  return {};
}

}  // namespace plvo::cli
