// SPDX-License-Identifier: Apache-2.0
// The file of the samples of wheel odometry: `stamp vx vy wz`, or `stamp vx vy wz sigma_vx sigma_vy sigma_wz`
// with standard deviations; m/s and rad/s in the axes of the robot's base (x forward, y left, z up); `#`
// comments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

inline constexpr const char* kWheelFile = "wheel_odometry.txt";

struct WheelSample {
  std::int64_t stamp_ns = 0;
  Vector3 velocity = Vector3::Zero();  // vx vy wz
  Vector3 sigma = Vector3::Zero();     // where WheelRecording::has_sigma
};

struct WheelRecording {
  std::vector<WheelSample> samples;  // stamps increase
  bool has_sigma = false;
  std::size_t ignored = 0;  // samples not later than the one before, or not finite
};

// Returns the errors of read_text_file; kDamaged, naming file and line, for a row that cannot be parsed, has
// other columns than the first, or a standard deviation that is not positive; kInvalidArgument for a file
// without a sample.
Status read_wheel_file(const std::filesystem::path& path, WheelRecording& recording);

// Returns kIo with the operating system's reason.
Status write_wheel_file(const std::filesystem::path& path, const WheelRecording& recording);

}  // namespace plvo
