// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/run/wheel_options.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "plvo/cli/options/arguments.hpp"

namespace plvo::cli {
namespace {

// Beyond them a unit is more likely to be wrong than a robot to be that quick.
constexpr double kQuick_mps = 20, kQuick_rps = 10;

}  // namespace

void add_wheel_options(CLI::App& command, WheelOptions& options, WheelSource source) {
  const bool live = source == WheelSource::kStream;
  OptionGroup group(command);
  group.path(
      "--wheels", options.file,
      fmt::format("With wheel odometry{}: 'stamp vx vy wz' per line (m/s, rad/s of the robot's base), or "
                  "also 'sigma_vx sigma_vy sigma_wz'; --base-camera says where the camera sits",
                  live ? ", as it comes through a named pipe, a serial port or - (standard input)" : ""),
      live ? "FILE|-" : "FILE");
  group.number(
      "--wheels-error", options.share, {0, 1}, "SHARE",
      fmt::format("Of lines without sigma: how far the wheels are off, as a share of the speed, slip "
                  "included (default {})",
                  WheelConfig().share));
}

void check_wheel_options(const CLI::App& command, const WheelOptions& options, const BaseOption& base) {
  if (options.file.empty())
    return refuse_options(command, {"--wheels-error"}, "is for --wheels: add that, or leave this out");
  if (base.numbers.empty())
    refuse("--wheels", "needs --base-camera: where the camera sits in the robot whose wheels these are");
}

WheelConfig wheel_config(const WheelOptions& options, const BaseOption& base) {
  WheelConfig config;
  config.T_base_camera = *base.T_base_camera;
  config.share = options.share;
  return config;
}

void QuickWheels::add(const WheelSample& sample) {
  speed_ = std::max(speed_, sample.velocity.head<2>().norm());
  turn_rate_ = std::max(turn_rate_, std::abs(sample.velocity.z()));
}

void QuickWheels::tell(Log& log) {
  if (speed_ > kQuick_mps && !std::exchange(told_speed_, true))
    log.write(LogLevel::kWarning,
              fmt::format("the wheels drive at up to {:.3g} m/s: are their speeds in m/s?", speed_));
  if (turn_rate_ > kQuick_rps && !std::exchange(told_turn_rate_, true))
    log.write(LogLevel::kWarning,
              fmt::format("the wheels turn at up to {:.3g} rad/s: are their rates in rad/s?", turn_rate_));
}

Status open_wheels(const WheelOptions& options, const BaseOption& base, Log& log,
                   std::optional<WheelPriors>& wheels) {
  if (options.file.empty()) return {};
  WheelRecording recording;
  if (Status status = read_wheel_file(options.file, recording); !status.ok()) return status;
  if (recording.ignored > 0)
    log.write(LogLevel::kWarning, fmt::format("{} samples of the wheels left out: not finite, or not later "
                                              "than the one before",
                                              recording.ignored));
  QuickWheels quick;
  for (const WheelSample& sample : recording.samples) quick.add(sample);
  const Status status = wheels.emplace().init(std::move(recording), wheel_config(options, base));
  if (status.ok()) quick.tell(log);
  return status;
}

}  // namespace plvo::cli
