// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/wheel_files.hpp"

#include <fmt/core.h>

#include <string>

#include "plvo/host/files/input_file.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/files/stamp_text.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWithoutSigma = 4, kWithSigma = 7;  // columns

}  // namespace

Status WheelRows::parse(const fs::path& source, const TableRow& row, WheelSample& sample) {
  const std::size_t columns = row.words.size();
  if (columns_ == 0 && columns != kWithoutSigma && columns != kWithSigma)
    return row_error(source, row,
                     "must have 4 columns (stamp vx vy wz) or 7 (and sigma_vx sigma_vy sigma_wz)");
  if (columns_ != 0 && columns != columns_)
    return row_error(source, row, fmt::format("has {} columns where {} are needed", columns, columns_));
  if (!parse_stamp_ns(row.words[0], sample.stamp_ns))
    return row_error(source, row, stamp_error(row.words[0]));
  std::vector<double> values(columns - 1);
  if (Status status = parse_numbers(source, row, 1, values); !status.ok()) return status;
  sample.velocity = Vector3(values[0], values[1], values[2]);
  sample.sigma = columns == kWithSigma ? Vector3(values[3], values[4], values[5]) : Vector3(Vector3::Zero());
  if (columns == kWithSigma && sample.sigma.minCoeff() <= 0)
    return row_error(source, row, "a standard deviation must be greater than 0");
  columns_ = columns;
  return {};
}

bool WheelRows::has_sigma() const { return columns_ == kWithSigma; }

std::string wheel_header(bool with_sigma) {
  return fmt::format("# timestamp vx vy wz{} (m/s and rad/s of the robot's base: x forward, y left, z up)",
                     with_sigma ? " sigma_vx sigma_vy sigma_wz" : "");
}

std::string wheel_line(const WheelSample& sample, bool with_sigma) {
  const Vector3 &v = sample.velocity, &s = sample.sigma;
  std::string line =
      fmt::format("{} {:.7f} {:.7f} {:.7f}", format_stamp(sample.stamp_ns), v.x(), v.y(), v.z());
  if (with_sigma) line += fmt::format(" {:.7g} {:.7g} {:.7g}", s.x(), s.y(), s.z());
  return line;
}

Status read_wheel_file(const fs::path& path, WheelRecording& recording) {
  recording = {};
  WheelRows rows;
  const Status status = each_row(path, kMaxTextBytes, [&](const TableRow& row) -> Status {
    WheelSample sample;
    if (Status parsed = rows.parse(path, row, sample); !parsed.ok()) return parsed;
    const bool later = recording.samples.empty() || sample.stamp_ns > recording.samples.back().stamp_ns;
    if (later && sample.velocity.allFinite() && sample.sigma.allFinite())
      recording.samples.push_back(sample);
    else
      ++recording.ignored;
    return {};
  });
  recording.has_sigma = rows.has_sigma();
  if (status.ok() && recording.samples.empty())
    return {StatusCode::kInvalidArgument, fmt::format("{} has no sample of the wheels", path.string())};
  return status;
}

Status refuse_wheel_file(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder / kWheelFile, error)) return {};
  return {StatusCode::kInvalidArgument,
          fmt::format("{} has {} already: remove it or choose another folder", folder.string(), kWheelFile)};
}

Status write_wheel_file(const fs::path& path, const WheelRecording& recording) {
  LineFile file;
  Status status = file.open(path, wheel_header(recording.has_sigma));
  for (std::size_t i = 0; status.ok() && i < recording.samples.size(); ++i)
    status = file.write(wheel_line(recording.samples[i], recording.has_sigma));
  return status;
}

}  // namespace plvo
