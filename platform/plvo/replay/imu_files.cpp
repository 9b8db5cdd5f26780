// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/imu_files.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "plvo/host/input_file.hpp"
#include "plvo/host/line_file.hpp"
#include "plvo/host/stamp_text.hpp"
#include "plvo/host/table_reader.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

// The words of a line without its comment.
std::vector<std::string> columns_of(std::string_view line) {
  std::vector<std::string> words;
  line = line.substr(0, line.find('#'));
  constexpr std::string_view kBetween = " \t\r,";
  for (;;) {
    line.remove_prefix(std::min(line.find_first_not_of(kBetween), line.size()));
    if (line.empty()) return words;
    words.emplace_back(line.substr(0, line.find_first_of(kBetween)));
    line.remove_prefix(words.back().size());
  }
}

Status read_samples(const fs::path& path, std::vector<ImuSample>& samples, std::size_t& ignored) {
  std::string content;
  if (Status status = read_text_file(path, kMaxTextBytes, content); !status.ok()) return status;
  std::vector<double> values(3);
  std::string_view rest = content;
  for (int line = 1; !rest.empty(); ++line) {
    const std::string_view text = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), text.size() + 1));
    const TableRow row{line, columns_of(text), false};
    if (row.words.empty()) continue;
    ImuSample sample;
    if (!parse_stamp_ns(row.words[0], sample.stamp_ns))
      return row_error(path, row, fmt::format("'{}' is not a stamp", row.words[0]));
    if (Status status = parse_numbers(path, row, 1, values); !status.ok()) return status;
    sample.value = Vector3(values[0], values[1], values[2]);
    const bool later = samples.empty() || sample.stamp_ns > samples.back().stamp_ns;
    if (later && sample.value.allFinite())
      samples.push_back(sample);
    else
      ++ignored;
  }
  return {};
}

Status write_samples(const fs::path& path, const char* header, const std::vector<ImuSample>& samples) {
  LineFile file;
  Status status = file.open(path, header);
  for (std::size_t i = 0; status.ok() && i < samples.size(); ++i) {
    const ImuSample& sample = samples[i];
    status = file.write(fmt::format("{} {:.7f} {:.7f} {:.7f}", format_stamp(sample.stamp_ns),
                                    sample.value.x(), sample.value.y(), sample.value.z()));
  }
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

Status write_imu_files(const fs::path& folder, const ImuRecording& recording) {
  Status status =
      write_samples(folder / kGyroFile, "# timestamp wx wy wz (rad/s, axes of the camera)", recording.gyro);
  if (status.ok())
    status = write_samples(folder / kAccelerometerFile, "# timestamp ax ay az (m/s^2, axes of the camera)",
                           recording.accelerometer);
  return status;
}

}  // namespace plvo
