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
  // Of the base, where there is one; of each frame, in order.
  TrackResult apply(const TrackResult& result);
  // Of the same frame, after apply(): T_map_odom, and the covariance of the base in the map.
  MapPose apply(const MapPose& map, const TrackResult& result) const;
};
void add_base_option(OptionGroup& group, BaseOption& option);
// Makes T_base_camera of the numbers; refuses a quaternion that is none, and the option where nothing that it
// changes is written.
// `--level`, for commands that have `--imu` as well, without which it is refused.
void add_level_option(OptionGroup& group, BaseOption& option);
void check_level_option(const CLI::App& command, bool imu);
void check_base_option(BaseOption& option, bool poses_are_written);
// Where the camera looks upwards because the turn to optical axes seems to be missing.
void warn_of_base_option(const BaseOption& option, Log& log);

}  // namespace plvo::cli
