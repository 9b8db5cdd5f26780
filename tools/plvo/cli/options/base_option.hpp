// SPDX-License-Identifier: Apache-2.0
// `--base-camera`: where the camera sits in the robot. What is written is then about the robot's base
// (plvo/host/robot_base.hpp).
#pragma once

#include <optional>
#include <vector>

#include "plvo/cli/options/arguments.hpp"
#include "plvo/hal/log.hpp"
#include "plvo/host/frame_names.hpp"
#include "plvo/host/stream/pose_json.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo::cli {

struct BaseOption {
  std::vector<double> numbers;  // tx ty tz qx qy qz qw
  std::optional<Se3> T_base_camera;

  bool level = false;               // the world is level: Config::level_world
  std::optional<Se3> T_odom_world;  // of the first pose, where it is

  const FrameNames& frames() const;
  // The result of the base, if there is one, else of the camera. To be called for each frame, in order.
  TrackResult apply(const TrackResult& result);
  // The same for the map, after apply() for this frame: T_map_odom, and the covariance of the base in the
  // map.
  MapPose apply(const MapPose& map, const TrackResult& result) const;
};
void add_base_option(OptionGroup& group, BaseOption& option);
// Converts the numbers to T_base_camera. Refuses a quaternion whose length is not 1, and the option if none
// of the outputs that it changes is written.
// `--level`, for commands that have `--imu` as well, without which it is refused.
void add_level_option(OptionGroup& group, BaseOption& option);
void check_level_option(const CLI::App& command, bool imu);
void check_base_option(BaseOption& option, bool poses_are_written);
// Where the camera looks upwards because the turn to optical axes seems to be missing.
void warn_of_base_option(const BaseOption& option, Log& log);

}  // namespace plvo::cli
