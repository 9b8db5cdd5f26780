// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/options/base_option.hpp"

#include <fmt/core.h>

#include <cmath>

#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/host/robot_base.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kOption = "--base-camera";
constexpr NumberRange kNumbers = {-1000, 1000};
constexpr double kLengthTolerance = 0.01;  // two decimals of a quaternion are enough

}  // namespace

const FrameNames& BaseOption::frames() const {
  if (T_base_camera) return level ? kLevelBaseFrames : kBaseFrames;
  return level ? kLevelFrames : kCameraFrames;
}

TrackResult BaseOption::apply(const TrackResult& result) {
  if (!T_base_camera) return result;
  if (!T_odom_world && level && has_pose(result))
    T_odom_world = level_odom(result.T_world_camera, *T_base_camera);
  return result_of_base(result, *T_base_camera, T_odom_world.value_or(*T_base_camera));
}

// The frame of the map is turned as odom is: it is the base where the camera was at the map's origin. In a
// level world, whose axes do not depend on how the camera sits, only the axes change.
MapPose BaseOption::apply(const MapPose& map, const TrackResult& result) const {
  if (!T_base_camera) return map;
  const Se3 T_map_optical = level ? Se3{rotation_body_optical(), Vector3::Zero()} : *T_base_camera;
  TrackResult in_map;
  in_map.T_world_camera = map.T_map_world * result.T_world_camera;
  in_map.pose_covariance = map.pose_covariance;
  MapPose of_base = map;
  of_base.pose_covariance = result_of_base(in_map, *T_base_camera, T_map_optical).pose_covariance;
  of_base.T_map_world = T_map_optical * map.T_map_world * T_odom_world.value_or(*T_base_camera).inverse();
  return of_base;
}

void add_level_option(OptionGroup& group, BaseOption& option) {
  group.flag("--level", option.level,
             "A level world, by the accelerometer of --imu: gravity along its y axis, or with --base-camera "
             "odom's z axis up; the first pose waits for the first reading");
}

void check_level_option(const CLI::App& command, bool imu) {
  if (!imu) refuse_options(command, {"--level"}, "is by the accelerometer of --imu: add that");
}

void add_base_option(OptionGroup& group, BaseOption& option) {
  takes_values(
      group.add(
          kOption, "NUMBER",
          "Where the camera (x right, y down, z forward) sits in the robot's base (x forward, y left, z up): "
          "tx ty tz qx qy qz qw. Files and streams are then of base_link in odom. A camera that looks "
          "ahead has the quaternion -0.5 0.5 -0.5 0.5",
          [&option](const std::string& text) {
            double number = 0;
            std::string wrong = read_number(text, kNumbers, number);
            if (wrong.empty()) option.numbers.push_back(number);
            return wrong;
          }),
      7, 7);
}

void check_base_option(BaseOption& option, bool poses_are_written) {
  const std::vector<double>& n = option.numbers;
  if (n.empty()) return;
  const double length = std::hypot(std::hypot(n[3], n[4]), std::hypot(n[5], n[6]));
  if (!(std::abs(length - 1) <= kLengthTolerance))
    refuse(
        kOption,
        fmt::format("the quaternion qx qy qz qw must have the length 1, not {:.4g}; after tx ty tz (metres) "
                    "come qx qy qz qw, w last",
                    length));
  if (!poses_are_written)
    refuse(kOption,
           "changes what is written: add --out, --covariance, --motions, --mavlink or --stream, or leave it "
           "out");
  option.T_base_camera = Se3{to_rotation({n[3], n[4], n[5], n[6]}), {n[0], n[1], n[2]}};
}

void warn_of_base_option(const BaseOption& option, Log& log) {
  constexpr double kNearlyOne = 0.9999;  // of the cosine of half the angle: 1.6°
  if (!option.numbers.empty() && std::abs(option.numbers[6]) > kNearlyOne)
    log.write(
        LogLevel::kWarning,
        "--base-camera has no rotation: this camera looks up, along the base's z, with the image's right "
        "to the front; one that looks ahead has the quaternion -0.5 0.5 -0.5 0.5");
}

}  // namespace plvo::cli
