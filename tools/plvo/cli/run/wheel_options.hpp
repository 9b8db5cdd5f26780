// SPDX-License-Identifier: Apache-2.0
// `--wheels`: wheel odometry that was recorded beside the images helps to track them.
#pragma once

#include <optional>
#include <string>

#include "plvo/cli/common/file_roles.hpp"
#include "plvo/cli/options/base_option.hpp"
#include "plvo/cli/options/camera_options.hpp"
#include "plvo/replay/recorded_wheels.hpp"

namespace plvo::cli {

struct WheelOptions {
  std::string file;
  double share = WheelConfig().share;
};
void add_wheel_options(CLI::App& command, WheelOptions& options);
// Refuses what does not apply to the camera of the command line, and --wheels without --base-camera.
void check_wheel_options(const CLI::App& command, const WheelOptions& options, const CameraOptions& camera,
                         const BaseOption& base);

// Leaves `wheels` empty where they were not asked for. log: for what was left out or looks wrong.
Status open_wheels(const WheelOptions& options, const BaseOption& base, Log& log,
                   std::optional<RecordedWheels>& wheels);

}  // namespace plvo::cli
