// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/trajectory.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "plvo/eval/table_reader.hpp"
#include "plvo/host/stamp_text.hpp"

namespace plvo::eval {
namespace {

constexpr std::int64_t kKittiPeriodNs = 100'000'000;
constexpr std::int64_t kMaxInterpolationGapNs = 100'000'000;
constexpr std::int64_t kSameStampNs = 1'000;  // closer than this to a sample, no neighbour is needed

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

// Seven numbers after the stamp; `w_first` is EuRoC's order of the quaternion.
Se3 pose_from(const std::vector<double>& v, bool w_first) {
  const Quaternion q = w_first ? Quaternion{v[4], v[5], v[6], v[3]} : Quaternion{v[3], v[4], v[5], v[6]};
  return {to_rotation(q), Vector3(v[0], v[1], v[2])};
}

Se3 pose_from_matrix(const std::vector<double>& v) {
  Se3 T;
  for (int row = 0; row < 3; ++row) {
    const auto first = static_cast<std::size_t>(row) * 4;
    for (int column = 0; column < 3; ++column) T.R(row, column) = v[first + static_cast<std::size_t>(column)];
    T.t[row] = v[first + 3];
  }
  return T;
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
  return {StatusCode::kInvalidArgument, fmt::format("{} has {} stamps for {} poses; it needs one for each",
                                                    path.string(), stamps.size(), needed)};
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

// Interpolation counts in doubles of seconds since 1970, as every script of the benchmark does: its stamps
// are rounded to 0.2 µs thereby, and the figures agree with those scripts to the last digit printed.
double seconds(std::int64_t stamp_ns) {
  return static_cast<double>(static_cast<long double>(stamp_ns) / 1e9L);
}

// Spherical linear interpolation of two unit quaternions, the shorter way round.
Quaternion slerp(const Quaternion& a, Quaternion b, double fraction) {
  double cosine = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
  if (cosine < 0) {
    b = {-b.x, -b.y, -b.z, -b.w};
    cosine = -cosine;
  }
  const double angle = std::acos(std::min(cosine, 1.0));
  const double sine = std::sin(angle);
  const bool small = sine < 1e-8;
  const double from = small ? 1 - fraction : std::sin((1 - fraction) * angle) / sine;
  const double to = small ? fraction : std::sin(fraction * angle) / sine;
  return {from * a.x + to * b.x, from * a.y + to * b.y, from * a.z + to * b.z, from * a.w + to * b.w};
}

}  // namespace

Status read_trajectory(const TrajectorySource& source, Trajectory& trajectory) {
  trajectory = {};
  std::vector<TableRow> rows;
  if (Status status = read_table(source.path, rows); !status.ok()) return status;
  if (rows.empty())
    return {StatusCode::kInvalidArgument, fmt::format("{} holds no pose", source.path.string())};
  const TrajectoryFormat format = source.format == TrajectoryFormat::kAuto ? detect(rows[0]) : source.format;
  const bool kitti = format == TrajectoryFormat::kKitti;
  trajectory.format = format;
  std::vector<std::int64_t> times;
  if (kitti && !source.kitti_times.empty()) {
    if (Status status = read_kitti_times(source.kitti_times, rows.size(), times); !status.ok()) return status;
  }
  std::vector<double> values(kitti ? 12 : 7);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    StampedPose pose;
    if (kitti) pose.stamp_ns = times.empty() ? static_cast<std::int64_t>(i) * kKittiPeriodNs : times[i];
    const bool stamp_read =
        kitti || (format == TrajectoryFormat::kEuroc ? parse_nanoseconds(rows[i].words[0], pose.stamp_ns)
                                                     : parse_stamp_ns(rows[i].words[0], pose.stamp_ns));
    if (!stamp_read)
      return row_error(source.path, rows[i], fmt::format("'{}' is not a stamp", rows[i].words[0]));
    if (Status status = parse_numbers(source.path, rows[i], kitti ? 0 : 1, values); !status.ok())
      return status;
    if (!all_finite(values)) {
      ++trajectory.ignored_rows;
      continue;
    }
    pose.T_world_camera =
        kitti ? pose_from_matrix(values) : pose_from(values, format == TrajectoryFormat::kEuroc);
    trajectory.poses.push_back(pose);
  }
  if (trajectory.poses.empty())
    return {StatusCode::kInvalidArgument,
            fmt::format("{} holds no pose without a NaN", source.path.string())};
  sort_by_stamp(trajectory);
  return {};
}

SampledPoses sample(const Trajectory& ground_truth, const std::vector<std::int64_t>& stamps_ns,
                    GroundTruthSampling sampling, std::int64_t max_difference_ns) {
  const auto& truth = ground_truth.poses;
  SampledPoses result;
  for (std::int64_t stamp : stamps_ns) {
    const auto after = std::lower_bound(truth.begin(), truth.end(), stamp,
                                        [](const StampedPose& p, std::int64_t t) { return p.stamp_ns < t; });
    const auto last = static_cast<std::ptrdiff_t>(truth.size()) - 1;
    const std::ptrdiff_t j =
        std::clamp<std::ptrdiff_t>(after - truth.begin(), std::min<std::ptrdiff_t>(1, last), last);
    const StampedPose& a = truth[static_cast<std::size_t>(std::max<std::ptrdiff_t>(j - 1, 0))];
    const StampedPose& b = truth[static_cast<std::size_t>(j)];
    const std::int64_t to_a = std::abs(a.stamp_ns - stamp);
    const std::int64_t to_b = std::abs(b.stamp_ns - stamp);
    if (sampling == GroundTruthSampling::kNearest || a.stamp_ns == b.stamp_ns) {
      result.poses.push_back(to_a <= to_b ? a.T_world_camera : b.T_world_camera);
      result.valid.push_back(std::min(to_a, to_b) <= max_difference_ns);
      continue;
    }
    const double fraction = std::clamp(
        (seconds(stamp) - seconds(a.stamp_ns)) / (seconds(b.stamp_ns) - seconds(a.stamp_ns)), 0.0, 1.0);
    const bool between = a.stamp_ns <= stamp && stamp <= b.stamp_ns;
    const bool close = b.stamp_ns - a.stamp_ns <= kMaxInterpolationGapNs;
    result.poses.push_back(
        {to_rotation(slerp(to_quaternion(a.T_world_camera.R), to_quaternion(b.T_world_camera.R), fraction)),
         a.T_world_camera.t * (1 - fraction) + b.T_world_camera.t * fraction});
    result.valid.push_back((between && close) || std::min(to_a, to_b) < kSameStampNs);
  }
  return result;
}

std::vector<double> path_lengths(const std::vector<Se3>& poses) {
  std::vector<double> lengths(poses.size(), 0);
  for (std::size_t i = 1; i < poses.size(); ++i)
    lengths[i] = lengths[i - 1] + (poses[i].t - poses[i - 1].t).norm();
  return lengths;
}

}  // namespace plvo::eval
