// SPDX-License-Identifier: Apache-2.0
// Files of the gyro and accelerometer samples of a sequence: gyroscope.txt (`stamp wx wy wz`, rad/s) and
// accelerometer.txt (`stamp ax ay az`, m/s², as TUM publishes it), `#` comments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
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

// Either file may be missing. Returns kNotFound if both are; kDamaged, naming file and line, for a line that
// cannot be parsed.
Status read_imu_files(const std::filesystem::path& folder, ImuRecording& recording);

// Axes of the readings, stated in the first line of a file. kSensor: the sensor's own, whichever they are.
enum class ImuAxes : std::uint8_t { kCamera, kKinect, kSensor };
std::string imu_header(std::string_view file, ImuAxes axes);
// Returns a line of either file, with all digits.
std::string imu_line(const ImuSample& sample);

// Returns kInvalidArgument for a folder that already has one of the two files, which would be overwritten.
Status refuse_imu_files(const std::filesystem::path& folder);

// Writes both files into the folder: simulated samples (kCamera) with seven decimals, recorded ones with all
// digits. An empty file of recorded samples is not written. Returns kIo with the operating system's
// reason.
Status write_imu_files(const std::filesystem::path& folder, const ImuRecording& recording,
                       ImuAxes axes = ImuAxes::kCamera);

}  // namespace plvo
