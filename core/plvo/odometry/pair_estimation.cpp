// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/pair_estimation.hpp"

#include <algorithm>

#include "plvo/odometry/stage_timer.hpp"

namespace plvo {
namespace {

// The first motion only has to lead the second search to within a pixel: a millimetre and a milliradian do.
// The second stops far below what the sensor can tell.
constexpr LmOptions kRough{.max_iterations = 5, .step_tolerance = 3e-4, .cost_tolerance = 1e-3};
constexpr LmOptions kFine{.max_iterations = 20, .step_tolerance = 1e-6, .cost_tolerance = 1e-9};

}  // namespace

void PairEstimation::init(const CameraModel& camera, const Config& config) {
  camera_ = camera;
  config_ = config;
}

MotionEstimate PairEstimation::solve(const MidExposure& features, const Se3& T_predicted, const LmOptions& lm,
                                     Arena& scratch, TrackResult& result) {
  const StageTimer timer(config_.stage_clock, result, Stage::kMotion);
  const ScratchScope scope(scratch);
  const std::size_t n = point_tracks_.matches.size();
  const PointConstraints::Workspace workspace = PointConstraints::Workspace::take(scratch, n);
  PointConstraints points(features.reference_points, point_tracks_.points, point_tracks_.matches.span(),
                          workspace);
  const std::size_t m = line_matches_.size();
  const LineConstraints::Workspace line_workspace = LineConstraints::Workspace::take(scratch, m);
  LineConstraints lines(features.reference_lines, features.current_lines, line_matches_.span(),
                        line_workspace);

  MotionOptions options;
  options.ransac.inlier_probability = config_.motion.inlier_probability;
  options.ransac.max_iterations = config_.motion.max_ransac_iterations;
  options.min_inliers = config_.motion.min_inliers;
  options.lm = lm;
  options.loss = config_.motion.robust ? RobustLoss::kHuber : RobustLoss::kNone;
  ConstraintSet* const sets[] = {&points, &lines};
  const MotionEstimate estimate = estimate_motion(sets, options, config_.seed, &T_predicted, scratch);

  std::copy(points.inliers().begin(), points.inliers().end(), point_inliers_.begin());
  std::copy(lines.inliers().begin(), lines.inliers().end(), line_inliers_.begin());
  result.lines.matched = static_cast<int>(m);
  result.lines.inliers = estimate.inliers[1];
  result.points.matched = static_cast<int>(n);
  result.points.inliers = estimate.inliers[0];
  result.ransac_iterations += estimate.ransac.iterations;
  result.lm_iterations += estimate.lm.iterations;
  return estimate;
}

MotionEstimate PairEstimation::estimate(const FrameFeatures& reference, const FrameFeatures& current,
                                        const Pyramid& pyramid, const DepthSampler& depth,
                                        const PairPrior& prior, double radius_px, Arena& scratch,
                                        TrackResult& result) {
  MotionEstimate first;
  {
    const ScratchScope scope(scratch);
    const Se3& T_predicted = prior.T_current_reference;
    const MidExposure features = at_mid_exposure(camera_, prior, T_predicted, reference, current, scratch);
    {
      const StageTimer timer(config_.stage_clock, result, Stage::kMatching);
      const TrackingView view{camera_.pinhole, config_.points, pyramid, depth, features.current};
      track_by_descriptor(view, reference.points, features.reference_points, current.points, T_predicted,
                          radius_px, scratch, point_tracks_);
      LineMatchConfig gates = config_.lines.match;
      gates.max_offset_px = std::max(gates.max_offset_px, radius_px);
      match_predicted_lines(camera_.pinhole, features.current, reference.lines, features.reference_lines,
                            current.lines, T_predicted, gates, scratch, line_matches_);
    }
    first = solve(features, T_predicted, kRough, scratch, result);
    if (first.status != StatusCode::kOk) return first;
  }
  const ScratchScope scope(scratch);
  const Se3& T_first = first.T_current_reference;
  const MidExposure features = at_mid_exposure(camera_, prior, T_first, reference, current, scratch);
  {
    const StageTimer timer(config_.stage_clock, result, Stage::kMatching);
    const TrackingView view{camera_.pinhole, config_.points, pyramid, depth, features.current};
    track_by_motion(view, reference.points, features.reference_points, T_first, point_tracks_);
    LineMatchConfig gates = config_.lines.match;
    gates.max_offset_px = config_.lines.guided_offset_px;
    gates.max_angle_rad = config_.lines.guided_angle_rad;
    match_predicted_lines(camera_.pinhole, features.current, reference.lines, features.reference_lines,
                          current.lines, T_first, gates, scratch, line_matches_);
  }
  return solve(features, T_first, kFine, scratch, result);
}

}  // namespace plvo
