// SPDX-License-Identifier: Apache-2.0
// Lines of the files that plvo writes; docs/user/outputs.md describes them to the user. The first is a
// comment: what the columns are, and in which frames (frame_names.hpp).
//   trajectory  stamp tx ty tz qx qy qz qw                        TUM; T_world_camera
//   covariance  stamp c00 c01 … c55                               36 numbers, row-major, of the pose
//   motions     stamp reference_stamp tx ty tz qx qy qz qw c00 …  T_camera_reference with its covariance
#pragma once

#include <cstdint>
#include <string>

#include "plvo/hal/pose_sink.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/frame_names.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo {

inline constexpr const char* kTrajectoryHeader = "# timestamp tx ty tz qx qy qz qw";
inline constexpr const char* kCovarianceHeader =
    "# timestamp, then the 6x6 covariance of the pose, row-major: position (m), orientation (rad), axes of "
    "the world";
inline constexpr const char* kMotionsHeader =
    "# timestamp reference_timestamp tx ty tz qx qy qz qw (frame from reference), then its 6x6 covariance, "
    "row-major";

// A frame that still waits for the first usable one is initialising, too, but says why in its status.
inline bool has_pose(const TrackResult& result) {
  return result.state == TrackState::kTracking || result.state == TrackState::kPredicted ||
         (result.state == TrackState::kInitialising && result.status.ok());
}

// Decimals are fixed (nine: a nanometre) so that equal results are equal bytes.
std::string pose_text(const Se3& T);
std::string trajectory_line(std::int64_t stamp_ns, const Se3& T_world_camera);
std::string covariance_line(std::int64_t stamp_ns, const Matrix6& covariance);
std::string motion_line(const TrackResult& result);

// The same as sinks: a line for each frame that has a pose (lost ones have none; the first one has no
// motion). Until open() made the file, write() does nothing.
class TrajectoryFile final : public PoseSink {
 public:
  Status open(const std::filesystem::path& path, const FrameNames& frames = kCameraFrames);
  Status write(const TrackResult& result) override;

 private:
  LineFile file_;
};

class CovarianceFile final : public PoseSink {
 public:
  Status open(const std::filesystem::path& path, const FrameNames& frames = kCameraFrames);
  Status write(const TrackResult& result) override;

 private:
  LineFile file_;
};

class MotionFile final : public PoseSink {
 public:
  Status open(const std::filesystem::path& path, const FrameNames& frames = kCameraFrames);
  Status write(const TrackResult& result) override;

 private:
  LineFile file_;
};

}  // namespace plvo
