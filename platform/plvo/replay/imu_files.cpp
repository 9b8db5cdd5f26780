// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/imu_files.hpp"

#include <fmt/core.h>

#include <string>
#include <string_view>

#include "plvo/host/files/input_file.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/files/stamp_text.hpp"
#include "plvo/host/files/table_reader.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

Status read_samples(const fs::path& path, std::vector<ImuSample>& samples, std::size_t& ignored) {
  std::vector<double> values(3);
  return each_row(path, kMaxTextBytes, [&](const TableRow& row) -> Status {
    ImuSample sample;
    if (!parse_stamp_ns(row.words[0], sample.stamp_ns))
      return row_error(path, row, stamp_error(row.words[0]));
    if (Status status = parse_numbers(path, row, 1, values); !status.ok()) return status;
    sample.value = Vector3(values[0], values[1], values[2]);
    const bool later = samples.empty() || sample.stamp_ns > samples.back().stamp_ns;
    if (later && sample.value.allFinite())
      samples.push_back(sample);
    else
      ++ignored;
    return {};
  });
}

std::string short_line(const ImuSample& sample) {
  return fmt::format("{} {:.7f} {:.7f} {:.7f}", format_stamp(sample.stamp_ns), sample.value.x(),
                     sample.value.y(), sample.value.z());
}

Status write_samples(const fs::path& folder, const char* name, const std::vector<ImuSample>& samples,
                     ImuAxes axes) {
  const bool simulated = axes == ImuAxes::kCamera;
  if (samples.empty() && !simulated) return {};
  LineFile file;
  Status status = file.open(folder / name, imu_header(name, axes));
  for (std::size_t i = 0; status.ok() && i < samples.size(); ++i)
    status = file.write(simulated ? short_line(samples[i]) : imu_line(samples[i]));
  return status;
}

}  // namespace

Status read_imu_files(const fs::path& folder, ImuRecording& recording) {
  recording = {};
  std::error_code error;
  const bool gyro = fs::exists(folder / kGyroFile, error);
  const bool accelerometer = fs::exists(folder / kAccelerometerFile, error);
  if (!gyro && !accelerometer)
    return {StatusCode::kNotFound,
            fmt::format("{} has neither {} nor {} ('stamp x y z' per line, rad/s and m/s^2)", folder.string(),
                        kGyroFile, kAccelerometerFile)};
  Status status;
  if (gyro) status = read_samples(folder / kGyroFile, recording.gyro, recording.ignored);
  if (status.ok() && accelerometer)
    status = read_samples(folder / kAccelerometerFile, recording.accelerometer, recording.ignored);
  return status;
}

std::string imu_header(std::string_view file, ImuAxes axes) {
  const char* columns = file == kGyroFile ? "wx wy wz (rad/s" : "ax ay az (m/s^2";
  const char* whose = axes == ImuAxes::kCamera   ? "axes of the camera"
                      : axes == ImuAxes::kKinect ? "axes of a Kinect: --imu-axes x,-y,z"
                                                 : "axes of the sensor";
  return fmt::format("# timestamp {}, {})", columns, whose);
}

std::string imu_line(const ImuSample& sample) {
  return fmt::format("{} {} {} {}", format_stamp(sample.stamp_ns), sample.value.x(), sample.value.y(),
                     sample.value.z());
}

Status refuse_imu_files(const fs::path& folder) {
  std::error_code error;
  for (const char* name : {kGyroFile, kAccelerometerFile})
    if (fs::exists(folder / name, error))
      return {StatusCode::kInvalidArgument,
              fmt::format("{} has {} already: remove it or choose another folder", folder.string(), name)};
  return {};
}

Status write_imu_files(const fs::path& folder, const ImuRecording& recording, ImuAxes axes) {
  Status status = write_samples(folder, kGyroFile, recording.gyro, axes);
  if (status.ok()) status = write_samples(folder, kAccelerometerFile, recording.accelerometer, axes);
  return status;
}

}  // namespace plvo
