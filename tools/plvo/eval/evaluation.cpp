// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/evaluation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "plvo/host/files/stamp_text.hpp"

namespace plvo::eval {
namespace {

constexpr double kLostSteps = 2.5;  // frames are missing in a step of more than this many medians
constexpr std::int64_t kSecondNs = 1'000'000'000;

std::vector<Interval> find_lost(const std::vector<StampedPose>& poses) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < poses.size(); ++i)
    steps.push_back(static_cast<double>(poses[i].stamp_ns - poses[i - 1].stamp_ns));
  const double median = statistics(steps).median;
  std::vector<Interval> lost;
  for (std::size_t i = 1; i < poses.size(); ++i)
    if (steps[i - 1] > kLostSteps * median) lost.push_back({poses[i - 1].stamp_ns, poses[i].stamp_ns});
  return lost;
}

std::vector<Interval> find_gaps(const std::vector<std::int64_t>& stamps, const std::vector<bool>& valid) {
  std::vector<Interval> gaps;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (valid[i]) continue;
    if (i > 0 && !valid[i - 1]) {
      gaps.back().end_ns = stamps[i];
    } else {
      gaps.push_back({stamps[i], stamps[i]});
    }
  }
  return gaps;
}

// Returns the poses of the estimate that have a true pose.
PairedPoses pair_poses(const Trajectory& estimate, const SampledPoses& truth) {
  PairedPoses poses;
  for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
    if (!truth.valid[i]) continue;
    poses.stamps_ns.push_back(estimate.poses[i].stamp_ns);
    poses.estimate.push_back(estimate.poses[i].T_world_camera);
    poses.truth.push_back(truth.poses[i]);
  }
  return poses;
}

// Rows without stamps are compared by their number.
Status check_rows(const Trajectory& truth, const Trajectory& estimate) {
  const std::size_t rows = estimate.poses.size() + estimate.ignored_rows,
                    true_rows = truth.poses.size() + truth.ignored_rows;
  if (!truth.stamped_by_row || !estimate.stamped_by_row || rows == true_rows) return {};
  return {StatusCode::kInvalidArgument,
          fmt::format(
              "the truth has {} rows and the estimate {}, and rows without stamps are compared one by one: a "
              "frame that one of them leaves out shifts all that follow; give the stamps of both, "
              "--kitti-times TRUTH ESTIMATE",
              true_rows, rows)};
}

// Explains from the stamps why hardly any pose has a true pose.
std::string why_apart(const Trajectory& truth, const Trajectory& estimate,
                      const std::vector<std::int64_t>& stamps) {
  if (stamps.empty() || truth.poses.empty()) return "one of the files has no pose";
  if (truth.stamped_by_row != estimate.stamped_by_row)
    return fmt::format("the {} has no stamps and counts as 0.1 s apart from 0; give them, --kitti-times FILE",
                       truth.stamped_by_row ? "truth" : "estimate");
  std::vector<std::int64_t> true_stamps;
  for (const StampedPose& pose : truth.poses) true_stamps.push_back(pose.stamp_ns);
  for (const auto& [who, list] :
       {std::pair("truth", &std::as_const(true_stamps)), std::pair("estimate", &stamps)})
    if (const std::string doubt = stamp_unit_doubt(*list); !doubt.empty())
      return fmt::format("the stamps of the {} look wrong, {}", who, doubt);
  const auto seconds = [](std::int64_t stamp_ns) { return static_cast<double>(stamp_ns) * 1e-9; };
  return fmt::format(
      "the truth goes from {:.2f} to {:.2f} s, the estimate from {:.2f} to {:.2f}; one recording, one clock? "
      "(--offset {:.2f} lets both begin together)",
      seconds(true_stamps.front()), seconds(true_stamps.back()), seconds(stamps.front()),
      seconds(stamps.back()), seconds(true_stamps.front()) - seconds(estimate.poses.front().stamp_ns));
}

}  // namespace

Status evaluate(const Trajectory& measured_truth, const Trajectory& estimate,
                const std::vector<StampedCovariance>& covariances,
                const std::vector<UncertainMotion>& motions, const EvaluationOptions& options,
                Evaluation& result) {
  result = {};
  if (Status status = check_rows(measured_truth, estimate); !status.ok()) return status;
  result.sampling = options.sampling.method;
  result.truth_sigma = options.truth_sigma;
  result.estimate_poses = estimate.poses.size();
  std::vector<std::int64_t> stamps;
  for (const StampedPose& pose : estimate.poses) stamps.push_back(pose.stamp_ns + options.offset_ns);
  Trajectory ground_truth = measured_truth;
  SampledPoses truth = sample(ground_truth, stamps, options.sampling);
  PairedPoses& poses = result.poses;
  poses = pair_poses(estimate, truth);
  if (poses.truth.size() < 2)
    return {StatusCode::kInvalidArgument,
            fmt::format("only {} of {} poses have ground truth at their stamp: {}", poses.truth.size(),
                        stamps.size(), why_apart(measured_truth, estimate, stamps))};
  const RpeDelta second = {1, RpeDelta::Unit::kSeconds, "1s"};
  if (options.fit_truth) {
    result.second_before_fit = relative_pose_error(poses, second).estimate;
    TruthFit& fit = result.truth_fit.emplace();
    if (Status status = fit_truth(measured_truth, estimate, options.offset_ns, fit); !status.ok())
      return status;
    ground_truth = corrected(measured_truth, fit);
    truth = sample(ground_truth, stamps, options.sampling);
    poses = pair_poses(estimate, truth);
  }
  result.duration_s = static_cast<double>(poses.stamps_ns.back() - poses.stamps_ns.front()) * 1e-9;
  result.path_m = path_lengths(poses.truth).back();

  std::vector<RpeDelta> deltas = options.deltas;
  if (deltas.empty()) deltas = {{1, RpeDelta::Unit::kFrames, "1f"}, second};
  for (const RpeDelta& delta : deltas) result.rpe.push_back(relative_pose_error(poses, delta));
  result.ate = absolute_trajectory_error(poses.estimate, poses.truth);
  result.ate_identity = identity_absolute_error(poses.truth);
  result.drift = end_drift(poses);
  result.drift_identity = identity_end_drift(poses);
  result.by_distance = distance_errors(poses);
  result.lost = find_lost(estimate.poses);
  result.without_truth = find_gaps(stamps, truth.valid);

  result.errors = pose_errors(poses, covariances);
  if (!covariances.empty()) result.pose_nees = pose_consistency(poses, covariances, options.truth_sigma);
  if (!motions.empty()) {
    std::vector<UncertainMotion> shifted = motions;
    for (UncertainMotion& motion : shifted) {
      motion.stamp_ns += options.offset_ns;
      motion.reference_stamp_ns += options.offset_ns;
    }
    result.motion_nees = motion_consistency(shifted, ground_truth, options.sampling, options.truth_sigma);
    result.second_nees =
        span_consistency(shifted, kSecondNs, ground_truth, options.sampling, options.truth_sigma);
  }
  return {};
}

}  // namespace plvo::eval
