// SPDX-License-Identifier: Apache-2.0
// `--wheels`: wheel odometry helps to track the images; of a file that was recorded beside them, or, live, as
// it comes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "plvo/cli/common/file_roles.hpp"
#include "plvo/cli/options/base_option.hpp"
#include "plvo/replay/wheel_priors.hpp"

namespace plvo::cli {

struct WheelOptions {
  std::string file;
  double share = WheelConfig().share;
};
enum class WheelSource : std::uint8_t { kFile, kStream };
void add_wheel_options(CLI::App& command, WheelOptions& options, WheelSource source);
// Refuses --wheels without --base-camera.
void check_wheel_options(const CLI::App& command, const WheelOptions& options, const BaseOption& base);
WheelConfig wheel_config(const WheelOptions& options, const BaseOption& base);

// Tells of speeds and of turn rates that no robot has, of each once.
class QuickWheels {
 public:
  void add(const WheelSample& sample);
  void tell(Log& log);

 private:
  double speed_ = 0, turn_rate_ = 0;
  bool told_speed_ = false, told_turn_rate_ = false;
};

// Leaves `wheels` empty where they were not asked for. log: for what was left out or looks wrong.
Status open_wheels(const WheelOptions& options, const BaseOption& base, Log& log,
                   std::optional<WheelPriors>& wheels);

}  // namespace plvo::cli
