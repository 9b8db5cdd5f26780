// SPDX-License-Identifier: Apache-2.0
// What a gyro and an accelerometer recorded beside a sequence: gyroscope.txt (`stamp wx wy wz`, rad/s) and
// accelerometer.txt (`stamp ax ay az`, m/s², as TUM publishes it), `#` comments.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/inertial/imu_integrator.hpp"

namespace plvo {

inline constexpr const char* kGyroFile = "gyroscope.txt";
inline constexpr const char* kAccelerometerFile = "accelerometer.txt";

struct ImuRecording {
  std::vector<ImuSample> gyro, accelerometer;
  std::size_t ignored = 0;  // samples not later than the one before, or not finite
};

// Either file may be missing; kNotFound when both are. kDamaged, naming file and line, for a line that is not
// understood.
Status read_imu_files(const std::filesystem::path& folder, ImuRecording& recording);

// Writes both into the folder. kIo with the operating system's reason.
Status write_imu_files(const std::filesystem::path& folder, const ImuRecording& recording);

}  // namespace plvo
