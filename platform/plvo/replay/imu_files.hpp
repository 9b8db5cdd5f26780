// SPDX-License-Identifier: Apache-2.0
// What a gyro and an accelerometer recorded beside a sequence: gyroscope.txt (`stamp wx wy wz`, rad/s) and
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

// Either file may be missing; kNotFound when both are. kDamaged, naming file and line, for a line that is not
// understood.
Status read_imu_files(const std::filesystem::path& folder, ImuRecording& recording);

// In which axes readings are: what the first line of a file says. kSensor: in its own, whichever they are.
enum class ImuAxes : std::uint8_t { kCamera, kKinect, kSensor };
std::string imu_header(std::string_view file, ImuAxes axes);
// A line of either file, with all digits.
std::string imu_line(const ImuSample& sample);

// kInvalidArgument for a folder that has one of the two already, which would be overwritten.
Status refuse_imu_files(const std::filesystem::path& folder);

// Writes both into the folder: simulated ones (kCamera) with seven decimals, recorded ones with all digits,
// and of those no file without a reading. kIo with the operating system's reason.
Status write_imu_files(const std::filesystem::path& folder, const ImuRecording& recording,
                       ImuAxes axes = ImuAxes::kCamera);

}  // namespace plvo
