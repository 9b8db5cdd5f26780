// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/trajectory_file.hpp"

#include <fmt/format.h>

#include <iterator>

#include "plvo/host/files/stamp_text.hpp"

namespace plvo {
namespace {

void append_covariance(std::string& line, const Matrix6& covariance) {
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      fmt::format_to(std::back_inserter(line), " {:.9e}", covariance(row, column));
}

// The first line says what the columns are, and in which frames.
Status open_with(LineFile& file, const std::filesystem::path& path, const char* columns,
                 const std::string& frames) {
  return file.open(path, columns + ("; " + frames));
}

std::string pose_frames(const FrameNames& frames) {
  return fmt::format("frame_id: {}, child_frame_id: {} ({}; the world is {})", frames.world, frames.body,
                     frames.axes, frames.origin);
}

std::string motion_frames(const FrameNames& frames) {
  return fmt::format("frame_id: {0}, child_frame_id: {0} at the reference_timestamp ({1})", frames.body,
                     frames.axes);
}

}  // namespace

std::string pose_text(const Se3& T) {
  const Quaternion q = to_quaternion(T.R);
  return fmt::format("{:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}", T.t.x(), T.t.y(), T.t.z(), q.x, q.y,
                     q.z, q.w);
}

std::string trajectory_line(std::int64_t stamp_ns, const Se3& T_world_camera) {
  return format_stamp(stamp_ns) + ' ' + pose_text(T_world_camera);
}

std::string covariance_line(std::int64_t stamp_ns, const Matrix6& covariance) {
  std::string line = format_stamp(stamp_ns);
  append_covariance(line, covariance);
  return line;
}

std::string motion_line(const TrackResult& result) {
  std::string line = format_stamp(result.stamp_ns) + ' ' + format_stamp(result.reference_stamp_ns) + ' ' +
                     pose_text(result.T_camera_reference);
  append_covariance(line, result.motion_covariance);
  return line;
}

Status TrajectoryFile::open(const std::filesystem::path& path, const FrameNames& frames) {
  return open_with(file_, path, kTrajectoryHeader, pose_frames(frames));
}

Status TrajectoryFile::write(const TrackResult& result) {
  if (!has_pose(result)) return {};
  return file_.write(trajectory_line(result.stamp_ns, result.T_world_camera));
}

Status CovarianceFile::open(const std::filesystem::path& path, const FrameNames& frames) {
  return open_with(file_, path, kCovarianceHeader, pose_frames(frames));
}

Status CovarianceFile::write(const TrackResult& result) {
  if (!has_pose(result)) return {};
  return file_.write(covariance_line(result.stamp_ns, result.pose_covariance));
}

Status MotionFile::open(const std::filesystem::path& path, const FrameNames& frames) {
  return open_with(file_, path, kMotionsHeader, motion_frames(frames));
}

Status MotionFile::write(const TrackResult& result) {
  if (result.state != TrackState::kTracking) return {};
  return file_.write(motion_line(result));
}

}  // namespace plvo
