// SPDX-License-Identifier: Apache-2.0
#include "measure.hpp"

#include <limits>

#include "plvo/odometry/odometry.hpp"

namespace plvo::accuracy {
namespace {

constexpr std::size_t kFirstFrames = 3;
constexpr int kPrincipalPoints = 2;
constexpr double kPrincipalPointStep_px = 0.05;

struct Track {
  eval::Trajectory trajectory;  // of a lost frame: the last good pose, so that losing a frame gains nothing
  std::vector<eval::UncertainMotion> motions;
  int lost = 0;
};

Status track(const Sequence& sequence, std::size_t first, const CameraModel& camera, const Config& config,
             Track& track) {
  Limits limits;
  limits.width = camera.width;
  limits.height = camera.height;
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  if (Status status = odometry.init(memory, camera, config, limits); !status.ok()) return status;
  for (std::size_t i = first; i < sequence.frames.size(); ++i) {
    const TrackResult result = odometry.track(sequence.frames[i].frame());
    track.trajectory.poses.push_back({result.stamp_ns, result.T_world_camera});
    if (result.state == TrackState::kLost) ++track.lost;
    if (result.state == TrackState::kTracking)
      track.motions.push_back(
          {result.stamp_ns, result.reference_stamp_ns, result.T_camera_reference, result.motion_covariance});
  }
  return {};
}

Figures figures_of(const Sequence& sequence, const Track& track) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Figures figures{kNone, kNone, kNone, track.lost};
  if (track.motions.empty()) return figures;
  eval::EvaluationOptions options = sequence.evaluation;
  options.deltas = {{1, eval::RpeDelta::Unit::kSeconds, "1s"}};
  eval::Evaluation evaluation;
  if (!eval::evaluate(sequence.truth, track.trajectory, {}, track.motions, options, evaluation).ok())
    return figures;
  // The errors against the truth as it was measured: a fit to the estimate would flatter it.
  const eval::RpeErrors& second =
      options.fit_truth ? evaluation.second_before_fit : evaluation.rpe.front().estimate;
  if (second.translation_m.count > 0) {
    figures.translation_mm_per_s = second.translation_m.rmse * 1e3;
    figures.rotation_deg_per_s = second.rotation_deg.rmse;
  }
  if (evaluation.second_nees && evaluation.second_nees->count > 0)
    figures.nees = evaluation.second_nees->all.mean;
  return figures;
}

}  // namespace

Status measure(const Sequence& sequence, const Config& config, std::vector<Figures>& starts) {
  starts.clear();
  Config seeded = config;
  for (int shift = 0; shift < kPrincipalPoints; ++shift) {
    CameraModel camera = sequence.camera;
    camera.pinhole.cx += shift * kPrincipalPointStep_px;
    for (std::size_t first = 0; first < kFirstFrames; ++first) {
      Track one;
      seeded.seed = starts.size() + 1;
      if (Status status = track(sequence, first, camera, seeded, one); !status.ok()) return status;
      starts.push_back(figures_of(sequence, one));
    }
  }
  return {};
}

}  // namespace plvo::accuracy
