// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/trajectory_reader.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "plvo/host/stamp_text.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kKittiPeriodNs = 100'000'000;

TrajectoryFormat detect(const TableRow& row) {
  if (row.words.size() == 12 && !row.commas) return TrajectoryFormat::kKitti;
  // No clock in seconds shows 15 digits before the point; one in nanoseconds since 1970 shows 19.
  const std::size_t digits = row.words[0].find('.') == std::string::npos ? row.words[0].size() : 0;
  return row.commas && digits >= 15 ? TrajectoryFormat::kEuroc : TrajectoryFormat::kTum;
}

bool parse_nanoseconds(const std::string& word, std::int64_t& stamp_ns) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), stamp_ns);
  return error == std::errc() && end == word.data() + word.size();
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// False for what is far from unit length, above all the zero quaternion of a system that had no pose.
bool is_rotation(const Quaternion& q) {
  const double squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  return !(squared < 0.25 || squared > 4);  // a NaN is told by its own rule
}

bool is_rotation_as_written(const Matrix3& R) {
  return !((R.transpose() * R - Matrix3::Identity()).norm() > 0.1) && !(R.determinant() < 0);
}

Status quaternion_pose(const std::filesystem::path& path, const TableRow& row, const Vector3& t,
                       const Quaternion& q, Se3& pose) {
  if (!is_rotation(q))
    return row_error(
        path, row,
        fmt::format("the quaternion (x y z w = {} {} {} {}) must have length 1; a row without a pose "
                    "must be left out",
                    q.x, q.y, q.z, q.w));
  pose = {to_rotation(q), t};
  return {};
}

Status read_kitti_times(const std::filesystem::path& path, std::size_t needed,
                        std::vector<std::int64_t>& stamps) {
  std::vector<TableRow> rows;
  if (Status status = read_table(path, rows); !status.ok()) return status;
  for (const TableRow& row : rows) {
    std::int64_t stamp = 0;
    if (!parse_stamp_ns(row.words[0], stamp)) return row_error(path, row, "expected a stamp in seconds");
    stamps.push_back(stamp);
  }
  if (stamps.size() == needed) return {};
  return {StatusCode::kInvalidArgument,
          fmt::format("{} has {} stamps for {} poses; there must be one for each", path.string(),
                      stamps.size(), needed)};
}

void sort_by_stamp(Trajectory& trajectory) {
  auto& poses = trajectory.poses;
  std::stable_sort(poses.begin(), poses.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.stamp_ns < b.stamp_ns; });
  const auto end = std::unique(poses.begin(), poses.end(), [](const StampedPose& a, const StampedPose& b) {
    return a.stamp_ns == b.stamp_ns;
  });
  trajectory.ignored_rows += static_cast<std::size_t>(poses.end() - end);
  poses.erase(end, poses.end());
}

// The pose of a row in any format; false in `usable` for one with a NaN.
Status row_pose(const std::filesystem::path& path, const TableRow& row, TrajectoryFormat format, Se3& pose,
                bool& usable) {
  const bool kitti = format == TrajectoryFormat::kKitti;
  std::vector<double> v(kitti ? 12 : 7);
  if (Status status = parse_numbers(path, row, kitti ? 0 : 1, v); !status.ok()) return status;
  usable = all_finite(v);
  if (!usable) return {};
  if (kitti) return matrix_pose(path, row, v, pose);
  const bool w_first = format == TrajectoryFormat::kEuroc;
  const Quaternion q = w_first ? Quaternion{v[4], v[5], v[6], v[3]} : Quaternion{v[3], v[4], v[5], v[6]};
  return quaternion_pose(path, row, Vector3(v[0], v[1], v[2]), q, pose);
}

}  // namespace

Status parse_pose(const std::filesystem::path& path, const TableRow& row, std::size_t first, Se3& pose) {
  std::vector<double> v(7);
  if (Status status = parse_numbers(path, row, first, v); !status.ok()) return status;
  return quaternion_pose(path, row, Vector3(v[0], v[1], v[2]), {v[3], v[4], v[5], v[6]}, pose);
}

Status matrix_pose(const std::filesystem::path& path, const TableRow& row, const std::vector<double>& v,
                   Se3& pose) {
  Se3 T;
  for (int i = 0; i < 3; ++i) {
    const auto first = static_cast<std::size_t>(i) * 4;
    for (int column = 0; column < 3; ++column) T.R(i, column) = v[first + static_cast<std::size_t>(column)];
    T.t[i] = v[first + 3];
  }
  if (!is_rotation_as_written(T.R)) return row_error(path, row, "the 3x3 part of the matrix is no rotation");
  pose = T;
  return {};
}

Status read_trajectory(const TrajectorySource& source, Trajectory& trajectory) {
  trajectory = {};
  std::vector<TableRow> rows;
  if (Status status = read_table(source.path, rows); !status.ok()) return status;
  if (rows.empty())
    return {StatusCode::kInvalidArgument, fmt::format("{} holds no pose", source.path.string())};
  const TrajectoryFormat format = source.format == TrajectoryFormat::kAuto ? detect(rows[0]) : source.format;
  const bool kitti = format == TrajectoryFormat::kKitti;
  std::vector<std::int64_t> times;
  if (kitti && !source.kitti_times.empty()) {
    if (Status status = read_kitti_times(source.kitti_times, rows.size(), times); !status.ok()) return status;
  }
  trajectory.format = format;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    StampedPose pose;
    if (kitti) pose.stamp_ns = times.empty() ? static_cast<std::int64_t>(i) * kKittiPeriodNs : times[i];
    const bool stamp_read =
        kitti || (format == TrajectoryFormat::kEuroc ? parse_nanoseconds(rows[i].words[0], pose.stamp_ns)
                                                     : parse_stamp_ns(rows[i].words[0], pose.stamp_ns));
    if (!stamp_read)
      return row_error(source.path, rows[i], fmt::format("'{}' is not a stamp", rows[i].words[0]));
    bool usable = false;
    if (Status status = row_pose(source.path, rows[i], format, pose.T_world_camera, usable); !status.ok())
      return status;
    if (!usable) {
      ++trajectory.ignored_rows;
      continue;
    }
    trajectory.poses.push_back(pose);
  }
  if (trajectory.poses.empty())
    return {StatusCode::kInvalidArgument,
            fmt::format("{} holds no pose without a NaN", source.path.string())};
  sort_by_stamp(trajectory);
  return {};
}

}  // namespace plvo
