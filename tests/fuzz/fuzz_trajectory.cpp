// SPDX-License-Identifier: Apache-2.0
// Any bytes as a trajectory in each format, as the pose file of a numbered frame, and as the files of
// covariances. Accepted data are sorted and finite.
#include "plvo/eval/trajectory.hpp"
#include "plvo/eval/uncertainty_file.hpp"
#include "plvo/replay/index/numbered_index.hpp"
#include "scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plvo;
  using eval::TrajectoryFormat;
  const auto path = fuzz::write_scratch("trajectory.txt", data, size);
  for (TrajectoryFormat format : {TrajectoryFormat::kAuto, TrajectoryFormat::kTum, TrajectoryFormat::kEuroc,
                                  TrajectoryFormat::kKitti}) {
    eval::Trajectory trajectory;
    if (!eval::read_trajectory({path, format, {}}, trajectory).ok()) continue;
    fuzz::require(!trajectory.poses.empty());
    for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
      fuzz::require(trajectory.poses[i].T_world_camera.is_finite());
      fuzz::require(i == 0 || trajectory.poses[i - 1].stamp_ns < trajectory.poses[i].stamp_ns);
    }
  }
  Trajectory poses;
  if (read_numbered_poses(fuzz::scratch_folder(), {{0, "trajectory.txt"}}, poses).ok())
    fuzz::require(poses.poses.size() == 1 && poses.poses[0].T_world_camera.is_finite());
  std::vector<eval::StampedCovariance> covariances;
  std::vector<eval::UncertainMotion> motions;
  (void)eval::read_covariances(path, covariances);
  (void)eval::read_motions(path, motions);
  return 0;
}
