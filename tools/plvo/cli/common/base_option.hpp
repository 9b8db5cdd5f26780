// SPDX-License-Identifier: Apache-2.0
// `--base-camera`: where the camera sits in the robot. What is written is then about the robot's base
// (plvo/host/robot_base.hpp).
#pragma once

#include <optional>
#include <vector>

#include "plvo/cli/common/arguments.hpp"
#include "plvo/hal/log.hpp"
#include "plvo/host/frame_names.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo::cli {

struct BaseOption {
  std::vector<double> numbers;  // tx ty tz qx qy qz qw
  std::optional<Se3> T_base_camera;

  const FrameNames& frames() const { return T_base_camera ? kBaseFrames : kCameraFrames; }
  // Of the base, where there is one.
  TrackResult apply(const TrackResult& result) const;
};
void add_base_option(OptionGroup& group, BaseOption& option);
// Makes T_base_camera of the numbers; refuses a quaternion that is none, and the option where nothing that it
// changes is written.
void check_base_option(BaseOption& option, bool poses_are_written);
// Where the camera looks upwards because the turn to optical axes seems to be missing.
void warn_of_base_option(const BaseOption& option, Log& log);

}  // namespace plvo::cli
