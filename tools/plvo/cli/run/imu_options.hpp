// SPDX-License-Identifier: Apache-2.0
// `--imu`: a gyro and an accelerometer that were recorded beside the images help to track them.
#pragma once

#include <optional>
#include <string>

#include "plvo/cli/options/camera_options.hpp"
#include "plvo/replay/recorded_imu.hpp"

namespace plvo::cli {

struct ImuOptions {
  bool used = false;
  Matrix3 R_camera_imu = Matrix3::Identity();
};
void add_imu_options(CLI::App& command, ImuOptions& options);
// Refuses what does not apply to the camera of the command line.
void check_imu_options(const CLI::App& command, const ImuOptions& options, const CameraOptions& camera);

// Leaves `imu` empty where it was not asked for. level: kNotFound without an accelerometer. log: for what is
// missing or was left out.
Status open_imu(const ImuOptions& options, const OpenedCamera& camera, bool level, Log& log,
                std::optional<RecordedImu>& imu);

// "x,-y,z": which of the sensor's axes points right, down and forward.
bool parse_imu_axes(const std::string& text, Matrix3& R_camera_imu);

}  // namespace plvo::cli
