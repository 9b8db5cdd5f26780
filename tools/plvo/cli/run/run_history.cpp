// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/run/run_history.hpp"

#include <fmt/core.h>

namespace plvo::cli {
namespace {

// Room whose pages are really there.
template <typename T>
void make_room(std::vector<T>& list, std::size_t count) {
  list.resize(count);
  list.clear();
}

}  // namespace

RunHistory::RunHistory(bool with_report, std::size_t pictures, std::size_t expected_frames)
    : with_report_(with_report), recorder_(with_report ? pictures : 0) {
  make_room(report_.trajectory.poses, expected_frames);
  make_room(covariances_, expected_frames);
  make_room(motions_, expected_frames);
}

void RunHistory::add(const FrameRecord& record, const RgbdFrame* frame, const Odometry& odometry) {
  const TrackResult& result = record.result;
  if (record.has_pose()) {
    report_.trajectory.poses.push_back({result.stamp_ns, result.T_world_camera});
    covariances_.push_back({result.stamp_ns, result.pose_covariance});
    if (result.state == TrackState::kTracking) {
      motions_.push_back(
          {result.stamp_ns, result.reference_stamp_ns, result.T_camera_reference, result.motion_covariance});
    }
  }
  if (!with_report_) return;
  report_.series.push_back(report::make_sample(result, record.damaged(), record.cpu_ns));
  if (frame == nullptr) return;
  recorder_.offer(record.number, *frame, result, odometry);
  scene_.offer(odometry);
}

Status RunHistory::evaluate(const OpenedCamera& camera) {
  const std::size_t poses = report_.trajectory.poses.size();
  if (!camera.ground_truth || poses < 2) return {};
  std::vector<std::int64_t> stamps;
  for (const eval::StampedPose& pose : report_.trajectory.poses) stamps.push_back(pose.stamp_ns);
  eval::Trajectory truth;
  if (Status status = camera.ground_truth(stamps, truth); !status.ok()) return status;
  eval::Evaluation evaluation;
  const Status compared = eval::evaluate(truth, report_.trajectory, covariances_, motions_, {}, evaluation);
  if (!compared.ok()) return Status(compared.code(), "no comparison: ").append(compared.message());
  report_.evaluation = std::move(evaluation);
  return {};
}

Status RunHistory::write_report(const std::string& path, const RunSummary& summary) {
  report_.title = summary.camera_name;
  report_.subtitle = fmt::format("plvo {}: {} frames, {} lost, {} damaged", PLVO_VERSION, summary.frames(),
                                 summary.lost(), summary.damaged());
  report_.frames = recorder_.frames();
  report_.scene = scene_.scene();
  report_.summary = summary.rows();
  return report::write_report(path, report_);
}

}  // namespace plvo::cli
