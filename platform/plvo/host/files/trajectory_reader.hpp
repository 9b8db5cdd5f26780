// SPDX-License-Identifier: Apache-2.0
// Trajectories from files:
//   TUM    stamp tx ty tz qx qy qz qw       seconds; spaces or commas
//   EuRoC  stamp,tx,ty,tz,qw,qx,qy,qz[,…]   nanoseconds, commas, w first; columns beyond the eighth are
//   ignored KITTI  r00 r01 r02 tx r10 … tz          12 numbers, the upper 3×4 of T_world_camera; stamps from
//   elsewhere
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/host/files/table_reader.hpp"
#include "plvo/math/se3.hpp"

namespace plvo {

struct StampedPose {
  std::int64_t stamp_ns = 0;
  Se3 T_world_camera;
};

enum class TrajectoryFormat : std::uint8_t { kAuto, kTum, kEuroc, kKitti };

struct Trajectory {
  std::vector<StampedPose> poses;                     // stamps strictly increasing
  std::size_t ignored_rows = 0;                       // with a NaN, or a stamp that was there already
  TrajectoryFormat format = TrajectoryFormat::kAuto;  // of the file that it was read from
  bool stamped_by_row = false;                        // KITTI without kitti_times
};

struct TrajectorySource {
  std::filesystem::path path;
  TrajectoryFormat format = TrajectoryFormat::kAuto;
  // One stamp in seconds for each KITTI row; without it, rows are 0.1 s apart from 0. Other formats bring
  // their own stamps.
  std::filesystem::path kitti_times;
};

// Rows are sorted by stamp. As read_text_file; kDamaged with file and line, also for a quaternion or a matrix
// that is no rotation; kInvalidArgument for a file without a pose, or with more or fewer poses than
// kitti_times has stamps.
Status read_trajectory(const TrajectorySource& source, Trajectory& trajectory);

// Sorts rows by stamp. Rows of equal stamp keep their order.
template <typename Stamped>
void sort_by_stamp(std::vector<Stamped>& rows) {
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Stamped& a, const Stamped& b) { return a.stamp_ns < b.stamp_ns; });
}

// Sorts by stamp and keeps the first row of each. Returns how many were dropped.
template <typename Stamped>
std::size_t keep_first_of_each_stamp(std::vector<Stamped>& rows) {
  sort_by_stamp(rows);
  const auto end = std::unique(rows.begin(), rows.end(),
                               [](const Stamped& a, const Stamped& b) { return a.stamp_ns == b.stamp_ns; });
  const auto dropped = static_cast<std::size_t>(rows.end() - end);
  rows.erase(end, rows.end());
  return dropped;
}

// A pose from columns first … first + 6 of a row: "tx ty tz qx qy qz qw". kDamaged as above; a pose with a
// NaN is read, not refused.
Status parse_pose(const std::filesystem::path& path, const TableRow& row, std::size_t first, Se3& pose);

// A pose from the rows of a matrix T_world_camera, 3×4 or 4×4, of finite numbers. kDamaged as above; row: for
// the message.
Status matrix_pose(const std::filesystem::path& path, const TableRow& row, const std::vector<double>& matrix,
                   Se3& pose);

}  // namespace plvo
