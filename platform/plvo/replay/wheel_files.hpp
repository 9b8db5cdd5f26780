// SPDX-License-Identifier: Apache-2.0
// The file of the samples of wheel odometry: `stamp vx vy wz`, or `stamp vx vy wz sigma_vx sigma_vy sigma_wz`
// with standard deviations; m/s and rad/s in the axes of the robot's base (x forward, y left, z up); `#`
// comments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/host/files/table_reader.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

inline constexpr const char* kWheelFile = "wheel_odometry.txt";

struct WheelSample {
  std::int64_t stamp_ns = 0;
  Vector3 velocity = Vector3::Zero();  // vx vy wz
  Vector3 sigma = Vector3::Zero();     // 0: not stated
};

struct WheelRecording {
  std::vector<WheelSample> samples;  // stamps increase
  bool has_sigma = false;
  std::size_t ignored = 0;  // samples not later than the one before, or not finite
};

// The lines of such a file, one after the other.
class WheelRows {
 public:
  // Returns kDamaged, naming source and line, for a row that cannot be parsed, has other columns than the
  // first good one, or a standard deviation that is not positive.
  Status parse(const std::filesystem::path& source, const TableRow& row, WheelSample& sample);
  bool has_sigma() const;

 private:
  std::size_t columns_ = 0;  // of the first good one
};

// As they are written.
std::string wheel_header(bool with_sigma);
std::string wheel_line(const WheelSample& sample, bool with_sigma);

// Returns the errors of read_text_file; those of WheelRows::parse; kInvalidArgument for a file without a
// sample.
Status read_wheel_file(const std::filesystem::path& path, WheelRecording& recording);

// Returns kIo with the operating system's reason.
Status write_wheel_file(const std::filesystem::path& path, const WheelRecording& recording);

// Returns kInvalidArgument if this folder has such a file, which somebody wants to keep.
Status refuse_wheel_file(const std::filesystem::path& folder);

}  // namespace plvo
