// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/trajectory_reader.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "plvo/host/files/input_file.hpp"
#include "plvo/host/files/stamp_text.hpp"
#include "plvo/host/number_text.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kKittiPeriodNs = 100'000'000;

TrajectoryFormat detect(const TableRow& row) {
  if (row.words.size() == 12 && !row.commas) return TrajectoryFormat::kKitti;
  // No clock in seconds shows 15 digits before the point; one in nanoseconds since 1970 shows 19.
  const std::size_t digits = row.words[0].find('.') == std::string::npos ? row.words[0].size() : 0;
  return row.commas && digits >= 15 ? TrajectoryFormat::kEuroc : TrajectoryFormat::kTum;
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

Status read_kitti_times(const std::filesystem::path& path, std::vector<std::int64_t>& stamps) {
  return each_row(path, kMaxTextBytes, [&](const TableRow& row) -> Status {
    std::int64_t stamp = 0;
    if (!parse_stamp_ns(row.words[0], stamp)) return row_error(path, row, stamp_error(row.words[0]));
    stamps.push_back(stamp);
    return {};
  });
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

// Takes the rows of a trajectory's file, one after the other.
class Rows {
 public:
  Rows(const TrajectorySource& source, Trajectory& trajectory) : source_(source), trajectory_(trajectory) {}

  Status take(const TableRow& row) {
    if (count_ == 0)
      if (Status status = begin(row); !status.ok()) return status;
    StampedPose pose;
    if (!parse_stamp(row, pose.stamp_ns)) return row_error(source_.path, row, stamp_error(row.words[0]));
    ++count_;
    bool usable = false;
    Status status = row_pose(source_.path, row, trajectory_.format, pose.T_world_camera, usable);
    if (!status.ok()) return status;
    if (usable)
      trajectory_.poses.push_back(pose);
    else
      ++trajectory_.ignored_rows;
    return {};
  }

  Status end() const {
    const std::string path = source_.path.string();
    if (count_ == 0) return {StatusCode::kInvalidArgument, fmt::format("{} holds no pose", path)};
    if (timed_ && times_.size() != count_)
      return {StatusCode::kInvalidArgument,
              fmt::format("{} has {} stamps for {} poses; there must be one for each",
                          source_.kitti_times.string(), times_.size(), count_)};
    if (trajectory_.poses.empty())
      return {StatusCode::kInvalidArgument, fmt::format("{} holds no pose without a NaN", path)};
    return {};
  }

 private:
  Status begin(const TableRow& first) {
    trajectory_.format = source_.format == TrajectoryFormat::kAuto ? detect(first) : source_.format;
    const bool kitti = trajectory_.format == TrajectoryFormat::kKitti;
    timed_ = kitti && !source_.kitti_times.empty();
    trajectory_.stamped_by_row = kitti && !timed_;
    return timed_ ? read_kitti_times(source_.kitti_times, times_) : Status();
  }

  bool parse_stamp(const TableRow& row, std::int64_t& stamp_ns) const {
    switch (trajectory_.format) {
      case TrajectoryFormat::kKitti:
        stamp_ns =
            count_ < times_.size() ? times_[count_] : static_cast<std::int64_t>(count_) * kKittiPeriodNs;
        return true;
      case TrajectoryFormat::kEuroc: return parse_whole_text(row.words[0], stamp_ns);
      default: return parse_stamp_ns(row.words[0], stamp_ns);
    }
  }

  const TrajectorySource& source_;
  Trajectory& trajectory_;
  std::vector<std::int64_t> times_;
  bool timed_ = false;  // by times_
  std::size_t count_ = 0;
};

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
  if (!is_rotation_as_written(T.R))
    return row_error(path, row, "the 3x3 part of the matrix is not a rotation");
  pose = T;
  return {};
}

Status read_trajectory(const TrajectorySource& source, Trajectory& trajectory) {
  trajectory = {};
  Rows rows(source, trajectory);
  Status status =
      each_row(source.path, kMaxTextBytes, [&rows](const TableRow& row) { return rows.take(row); });
  if (status.ok()) status = rows.end();
  if (!status.ok()) return status;
  trajectory.ignored_rows += keep_first_of_each_stamp(trajectory.poses);
  return {};
}

}  // namespace plvo
