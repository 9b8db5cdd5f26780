// SPDX-License-Identifier: Apache-2.0
// Trajectories from files:
//   TUM    stamp tx ty tz qx qy qz qw           seconds; spaces or commas
//   EuRoC  stamp,tx,ty,tz,qw,qx,qy,qz[,…]       nanoseconds, commas, w first; further columns are ignored
//   KITTI  r00 r01 r02 tx r10 … tz              12 numbers, the upper 3×4 of T_world_camera; stamps from
//   elsewhere
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::eval {

struct StampedPose {
  std::int64_t stamp_ns = 0;
  Se3 T_world_camera;
};

enum class TrajectoryFormat : std::uint8_t { kAuto, kTum, kEuroc, kKitti };

struct Trajectory {
  std::vector<StampedPose> poses;                     // stamps strictly increasing
  std::size_t ignored_rows = 0;                       // with a NaN, or a stamp that was there already
  TrajectoryFormat format = TrajectoryFormat::kAuto;  // of the file it was read from
};

struct TrajectorySource {
  std::filesystem::path path;
  TrajectoryFormat format = TrajectoryFormat::kAuto;
  std::filesystem::path
      kitti_times;  // a stamp in seconds for each row; without it, rows are 0.1 s apart from 0
};

// Rows are sorted by stamp. kNotFound; kDamaged with file and line; kInvalidArgument for a file without a
// pose.
Status read_trajectory(const TrajectorySource& source, Trajectory& trajectory);

enum class GroundTruthSampling : std::uint8_t {
  kNearest,       // the pose of the nearest stamp, as TUM's scripts do
  kInterpolated,  // between the two neighbours: linear, slerp; they may be at most 0.1 s apart
};

// The true pose at each stamp. valid[i] is false where there is none within max_difference_ns (nearest) or
// between close enough neighbours (interpolated).
struct SampledPoses {
  std::vector<Se3> poses;
  std::vector<bool> valid;
};
SampledPoses sample(const Trajectory& ground_truth, const std::vector<std::int64_t>& stamps_ns,
                    GroundTruthSampling sampling, std::int64_t max_difference_ns);

// Metres travelled up to each pose.
std::vector<double> path_lengths(const std::vector<Se3>& poses);

}  // namespace plvo::eval
