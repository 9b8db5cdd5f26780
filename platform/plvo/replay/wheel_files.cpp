// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/wheel_files.hpp"

#include <fmt/core.h>

#include <string>

#include "plvo/host/files/input_file.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/files/stamp_text.hpp"
#include "plvo/host/files/table_reader.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWithoutSigma = 4, kWithSigma = 7;  // columns

Status take_wheel_row(const fs::path& path, const TableRow& row, std::size_t columns,
                      WheelRecording& recording) {
  WheelSample sample;
  if (row.words.size() != columns)
    return row_error(path, row, fmt::format("has {} columns where {} are needed", row.words.size(), columns));
  if (!parse_stamp_ns(row.words[0], sample.stamp_ns)) return row_error(path, row, stamp_error(row.words[0]));
  std::vector<double> values(columns - 1);
  if (Status status = parse_numbers(path, row, 1, values); !status.ok()) return status;
  sample.velocity = Vector3(values[0], values[1], values[2]);
  if (recording.has_sigma) sample.sigma = Vector3(values[3], values[4], values[5]);
  if (recording.has_sigma && sample.sigma.minCoeff() <= 0)
    return row_error(path, row, "a standard deviation must be greater than 0");
  const bool later = recording.samples.empty() || sample.stamp_ns > recording.samples.back().stamp_ns;
  if (later && sample.velocity.allFinite() && sample.sigma.allFinite())
    recording.samples.push_back(sample);
  else
    ++recording.ignored;
  return {};
}

std::string wheel_line(const WheelSample& sample, bool with_sigma) {
  const Vector3 &v = sample.velocity, &s = sample.sigma;
  std::string line =
      fmt::format("{} {:.7f} {:.7f} {:.7f}", format_stamp(sample.stamp_ns), v.x(), v.y(), v.z());
  if (with_sigma) line += fmt::format(" {:.7g} {:.7g} {:.7g}", s.x(), s.y(), s.z());
  return line;
}

}  // namespace

Status read_wheel_file(const fs::path& path, WheelRecording& recording) {
  recording = {};
  std::size_t columns = 0;
  const Status status = each_row(path, kMaxTextBytes, [&](const TableRow& row) -> Status {
    if (columns == 0) {
      columns = row.words.size();
      if (columns != kWithoutSigma && columns != kWithSigma)
        return row_error(path, row,
                         "must have 4 columns (stamp vx vy wz) or 7 (and sigma_vx sigma_vy sigma_wz)");
      recording.has_sigma = columns == kWithSigma;
    }
    return take_wheel_row(path, row, columns, recording);
  });
  if (status.ok() && recording.samples.empty())
    return {StatusCode::kInvalidArgument, fmt::format("{} has no sample of the wheels", path.string())};
  return status;
}

Status write_wheel_file(const fs::path& path, const WheelRecording& recording) {
  LineFile file;
  Status status = file.open(path, fmt::format("# timestamp vx vy wz{} (m/s and rad/s of the robot's base: x "
                                              "forward, y left, z up)",
                                              recording.has_sigma ? " sigma_vx sigma_vy sigma_wz" : ""));
  for (std::size_t i = 0; status.ok() && i < recording.samples.size(); ++i)
    status = file.write(wheel_line(recording.samples[i], recording.has_sigma));
  return status;
}

}  // namespace plvo
