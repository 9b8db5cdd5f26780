// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/run/imu_options.hpp"

#include <fmt/core.h>

#include <string_view>
#include <utility>

#include "plvo/cli/live/live_camera.hpp"
#include "plvo/cli/options/arguments.hpp"

namespace plvo::cli {

bool parse_imu_axes(const std::string& text, Matrix3& R_camera_imu) {
  std::string_view rest = text;
  Matrix3 R = Matrix3::Zero();
  for (int row = 0; row < 3; ++row) {
    const bool negative = !rest.empty() && rest.front() == '-';
    if (negative) rest.remove_prefix(1);
    if (rest.empty() || rest.front() < 'x' || rest.front() > 'z') return false;
    R(row, rest.front() - 'x') = negative ? -1 : 1;
    rest.remove_prefix(1);
    if (row == 2) continue;
    if (rest.empty() || rest.front() != ',') return false;
    rest.remove_prefix(1);
  }
  if (!rest.empty() || R * R.transpose() != Matrix3::Identity()) return false;
  R_camera_imu = R;
  return true;
}

void add_imu_options(CLI::App& command, ImuOptions& options) {
  OptionGroup group(command);
  group.flag("--imu", options.used,
             "With gyroscope.txt (rad/s) and accelerometer.txt (m/s^2) of the folder, 'stamp x y z' per "
             "line, or with sensor_msgs/Imu of the ROS bag");
  group.add("--imu-axes", "AXES",
            "Which of their axes point right, down and forward (default x,y,z; of a Kinect: x,-y,z)",
            [&options](const std::string& text) -> std::string {
              if (parse_imu_axes(text, options.R_camera_imu)) return {};
              return expected("three different axes such as x,-y,z", text);
            });
}

void check_imu_options(const CLI::App& command, const ImuOptions& options, const CameraOptions& camera) {
  if (!options.used)
    refuse_options(command, {"--imu-axes", "--gyro-topic", "--accelerometer-topic"},
                   "is for --imu: add it, or leave this out");
  if (camera.simulated) refuse_options(command, {"--imu-axes"}, "is for recorded sequences");
  if (!camera.simulated && is_oni_file(camera.sequence))
    refuse_options(command, {"--imu"}, "does not apply to an .oni file, which holds no such readings");
}

Status open_imu(const ImuOptions& options, const OpenedCamera& camera, bool level, Log& log,
                std::optional<RecordedImu>& imu) {
  if (!options.used) return {};
  ImuRecording recording;
  if (Status status = camera.inertial(recording); !status.ok()) return status;
  if (level && recording.accelerometer.empty())
    return {StatusCode::kNotFound, "--level: without an accelerometer nothing says where down is"};
  if (recording.gyro.empty())
    log.write(LogLevel::kWarning,
              "no gyro: gravity alone helps; without wheels, a frame that shows nothing is lost");
  if (recording.accelerometer.empty())
    log.write(LogLevel::kWarning, "no accelerometer: nothing holds roll and pitch");
  if (recording.ignored > 0)
    log.write(LogLevel::kWarning,
              fmt::format("{} readings of gyro and accelerometer left out: damaged, not finite, or not "
                          "later than the one before",
                          recording.ignored));
  ImuConfig config;
  config.R_camera_imu = options.R_camera_imu;
  return imu.emplace().init(std::move(recording), config);
}

}  // namespace plvo::cli
