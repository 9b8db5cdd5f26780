// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/reference_tracking.hpp"

#include <algorithm>

#include "plvo/motion/prior_constraint.hpp"
#include "plvo/odometry/stage_timer.hpp"

namespace plvo {
namespace {

// The first motion only has to lead the second search to within a pixel: a millimetre and a milliradian
// suffice. The second takes its last step without another check when that step is a fifth of the sensor's
// resolution: the remaining error is then less than a twentieth.
constexpr LmOptions kRoughSolve{.max_iterations = 5, .step_tolerance = 3e-4};
constexpr LmOptions kFineSolve{.max_iterations = 20, .decrease_tolerance = 2e-2};

// Limits of the sparse alignment: rounds over a level, and Gauss–Newton steps in each. After a step smaller
// than kAligned (m and rad) another round brings nothing.
constexpr int kCoarseRounds = 4;
constexpr int kFineRounds = 1;
constexpr int kStepsOfRound = 2;
constexpr double kAligned = 5e-4;
// Gates of the lines once the motion is known.
constexpr double kGuidedOffset_px = 8;
constexpr double kGuidedAngle_rad = 0.1;

// All references are matched with the same measurements of the current frame: their residuals correlate by ½,
// and n such residuals weigh as n / (1 + (n − 1) / 2) independent ones.
double weight_of_one(std::size_t references) { return 2 / (1 + static_cast<double>(references)); }

// With a propagated prior, the covariance states how uncertain the directions are that vision leaves open.
// The bounds on the SDs are then this large, so that no estimate fails by them.
constexpr double kUnboundedSigma = 1e6;

// Order of the constraint sets of an estimate: points and lines of each reference, then the propagated prior,
// then surfaces. Inliers of points and lines are counted by this index; surfaces are never looked up by
// index.
constexpr std::size_t points_set(std::size_t reference) { return 2 * reference; }
constexpr std::size_t lines_set(std::size_t reference) { return 2 * reference + 1; }
constexpr std::size_t matched_sets(std::size_t references) { return 2 * references; }
static_assert(matched_sets(kMaxReferences) < kInformedKinds, "and the sensed motion");

void count(const MotionEstimate& estimate, std::span<ReferenceTracks> tracks, TrackResult& result) {
  result.points.matched = result.points.inliers = result.lines.matched = result.lines.inliers = 0;
  for (std::size_t r = 0; r < tracks.size(); ++r) {
    const int points = estimate.inliers[points_set(r)];
    const int lines = estimate.inliers[lines_set(r)];
    tracks[r].inliers = points + lines;
    result.points.matched += static_cast<int>(tracks[r].points.matches.size());
    result.lines.matched += static_cast<int>(tracks[r].lines.size());
    result.points.inliers += points;
    result.lines.inliers += lines;
  }
  result.ransac_iterations += estimate.ransac.iterations;
  result.lm_iterations += estimate.lm.iterations;
}

// Constraints from the matches with each reference; empty for a missing reference.
struct FeatureConstraints {
  std::array<PointConstraints, kMaxReferences> points;
  std::array<LineConstraints, kMaxReferences> lines;
  std::array<SurfaceConstraints, kMaxReferences> surfaces;
};

FeatureConstraints constraints_of(std::span<const RowTimeCompensation> features,
                                  std::span<const ReferenceTracks> tracks, const NoiseConfig& noise,
                                  Arena& scratch) {
  static_assert(kMaxReferences == 3);
  const double weight = weight_of_one(features.size());
  const RowTimeCompensation empty;
  const auto at = [&](std::size_t r) -> const RowTimeCompensation& {
    return r < features.size() ? features[r] : empty;
  };
  const auto count = [&](std::size_t r, std::size_t matches) { return r < features.size() ? matches : 0; };
  const auto points = [&](std::size_t r) {
    const PointTracks& found = tracks[r].points;
    const std::size_t n = count(r, found.matches.size());
    PointConstraints set(at(r).reference_points, found.points, found.matches.span().first(n),
                         PointConstraints::Workspace::take(scratch, n));
    set.set_reference(r, noise.point_correlation, weight);
    return set;
  };
  const auto lines = [&](std::size_t r) {
    const std::size_t n = count(r, tracks[r].lines.size());
    LineConstraints set(at(r).reference_lines, at(r).current_lines, tracks[r].lines.span().first(n),
                        LineConstraints::Workspace::take(scratch, n));
    set.set_reference(r, noise.line_correlation, weight);
    return set;
  };
  const auto surfaces = [&](std::size_t r) {
    const std::size_t n = count(r, tracks[r].surfaces.size());
    SurfaceConstraints set(tracks[r].surfaces.span().first(n),
                           SurfaceConstraints::Workspace::take(scratch, n));
    set.set_reference(r, noise.surface_correlation, weight);
    return set;
  };
  return {{points(0), points(1), points(2)},
          {lines(0), lines(1), lines(2)},
          {surfaces(0), surfaces(1), surfaces(2)}};
}

NuisanceParameters nuisance_parameters(const NoiseConfig& config, const Exposure& exposure,
                                       const NoiseScales& noise) {
  return {exposure, config.angular_rate_error_rad_per_s * sqrt(noise.angular_rate),
          config.shared_depth_m * sqrt(noise.shared_depth)};
}

TrackingView view_of(const CurrentFrame& current, const DepthSampler& depth, const Exposure& exposure) {
  const Config& config = current.extraction.config();
  return {current.extraction.camera().pinhole,
          config.points,
          current.extraction.pyramid(),
          depth,
          exposure,
          current.noise,
          config.executor};
}

}  // namespace

std::size_t latest_of(std::span<const Reference> references) {
  std::size_t latest = 0;
  for (std::size_t r = 1; r < references.size(); ++r)
    if (references[r].features->stamp_ns > references[latest].features->stamp_ns) latest = r;
  return latest;
}

bool is_share_of_view(int inliers, double share, std::span<const Reference> references,
                      const CameraModel& camera, const Se3& T_current_base) {
  // Nearly always the inliers are that share of all features, in view or not.
  std::size_t all = 0;
  for (const Reference& reference : references)
    all += reference.features->points.keypoints.size() + reference.features->lines.count_3d;
  if (inliers >= share * static_cast<double>(all)) return true;
  int in_view = 0;
  for (const Reference& reference : references) {
    const Se3 T_current_reference = T_current_base * reference.pose.T_reference_base.inverse();
    const auto is_seen = [&](const Vector3& p) {
      const Vector3 here = T_current_reference * p;
      if (!(here.z() > kNearestSeen_m)) return false;
      const Vector2 at = project(camera.pinhole, here);
      return at.x() >= 0 && at.y() >= 0 && at.x() <= camera.width - 1 && at.y() <= camera.height - 1;
    };
    const PointFeatures& points = reference.features->points;
    for (const Point3d& point : points.points.first(points.keypoints.size()))
      in_view += point.p.z() > 0 && is_seen(point.p) ? 1 : 0;
    for (const Line3d& line : reference.features->lines.lines_3d())
      in_view += is_seen(0.5 * (line.a + line.b)) ? 1 : 0;
  }
  return inliers >= share * in_view;
}

// Sets the poses relative to the first reference, and that of the last good frame, which may not be a
// reference.
ReferenceTracking::Indices ReferenceTracking::set_poses(std::span<const Reference> references,
                                                        const MotionReference& last,
                                                        MotionReferences& poses) {
  Indices at{latest_of(references), kMaxReferences};
  const Se3 T_base_first = references[0].pose.T_reference_base.inverse();
  poses[kMaxReferences] = {last.T_reference_base * T_base_first, last.covariance};
  for (std::size_t r = 0; r < references.size(); ++r) {
    if (r > 0) poses[r] = references[r].pose;
    if (references[r].prior.reference_is_last) at.last_frame = r;
  }
  return at;
}

void ReferenceTracking::solve(std::span<const RowTimeCompensation> features, const MotionReferences& poses,
                              const CurrentFrame& current, const Indices& at, const MotionStart& start,
                              const LmOptions& lm, Arena& scratch, TrackedMotion& tracked,
                              TrackResult& result) {
  const Config& config = current.extraction.config();
  const StageTimer timer(config, result, Stage::kMotion);
  const ScratchScope scope(scratch);
  FeatureConstraints constraints = constraints_of(features, tracks_, config.noise, scratch);
  std::array<ConstraintSet*, kMaxConstraintKinds> sets{};
  for (std::size_t r = 0; r < features.size(); ++r) {
    sets[points_set(r)] = &constraints.points[r];
    sets[lines_set(r)] = &constraints.lines[r];
  }
  std::size_t set_count = matched_sets(features.size());
  const PropagatedPrior& sensed = current.sensed;
  MotionConfig motion_config = config.motion;
  std::uint8_t prior_flag = 0;
  PriorConstraint prior(sensed.T_current_last(), sensed.covariance(), {&prior_flag, 1});
  if (sensed.known()) {
    prior.set_reference(at.last_frame, 0);
    sets[set_count++] = &prior;
    motion_config.max_sigma_m = motion_config.max_sigma_rad = kUnboundedSigma;
  }
  for (SurfaceConstraints& set : constraints.surfaces)
    if (set.size() > 0) sets[set_count++] = &set;

  tracked.exposure = {};
  tracked.observed = {};
  estimate_motion(std::span(sets).first(set_count), poses, motion_config, lm, config.seed, start, scratch,
                  tracked.motion);
  for (std::size_t r = 0; r < features.size(); ++r) {
    const std::span<const std::uint8_t> points = constraints.points[r].inliers();
    const std::span<const std::uint8_t> lines = constraints.lines[r].inliers();
    std::copy(points.begin(), points.end(), tracks_[r].point_inliers.begin());
    std::copy(lines.begin(), lines.end(), tracks_[r].line_inliers.begin());
  }
  count(tracked.motion, std::span(tracks_).first(features.size()), result);
  if (tracked.motion.status == StatusCode::kOk && config.noise.learning_rate > 0) {
    const std::size_t latest = at.latest;
    // The residuals use the poses as known before: with adjusted poses they would be smaller than the noise.
    const Se3 T_current_latest = motions_to_current(tracked.motion.T_current_reference, poses)[latest];
    const Pinhole& pinhole = current.extraction.camera().pinhole;
    tracked.observed = residual_scales(pinhole, constraints.points[latest], constraints.lines[latest],
                                       T_current_latest, scratch);
    tracked.observed.surfaces = surface_scale(constraints.surfaces[latest], T_current_latest, scratch);
    note_nuisance(start.shared, tracked.motion.shared, tracked.observed);
  }
}

// Not inlined: its variables are off the stack when the motion is solved for.
[[gnu::noinline]] bool ReferenceTracking::align(const Reference& reference, const CurrentFrame& current,
                                                Arena& scratch, Se3& T_current_reference,
                                                TrackResult& result) const {
  const Config& config = current.extraction.config();
  const CameraModel& camera = current.extraction.camera();
  if (!alignment_.holds(reference.features->stamp_ns)) return false;
  const StageTimer timer(config, result, Stage::kMatching);
  const ScratchScope scope(scratch);
  const PointFeatures& features = reference.features->points;
  const std::span<AlignmentWindow> storage = SparseAlignment::take_windows(scratch);
  const Pyramid& pyramid = current.extraction.pyramid();
  Se3 T = reference.prior.T_current_reference;
  AlignmentStep step;
  const auto take_rounds = [&](std::span<const AlignmentWindow> windows, int rounds) {
    for (int round = 0; round < rounds; ++round) {
      const ScratchScope exposed(scratch);
      // The effect of a rolling shutter depends on the motion, so it is compensated anew for each better
      // motion.
      const RowTimeCompensation at =
          compensate_row_times_of_points(camera, reference.prior, T, *reference.features, scratch);
      for (int i = 0; i < kStepsOfRound; ++i)
        if (!align_step(windows, at.reference_points, camera.pinhole, at.current_exposure, pyramid, T, step))
          return false;
      if (step.size < kAligned) break;
    }
    return true;
  };
  if (!take_rounds(alignment_.cut_coarse(features, storage), kCoarseRounds) || !step.trusted()) return false;
  if (!take_rounds(SparseAlignment::cut_fine(features, storage), kFineRounds)) return false;
  T_current_reference = T;
  return true;
}

void ReferenceTracking::find(const Reference& reference, const CurrentFrame& current, double radius_px,
                             Arena& scratch, TrackedMotion& tracked, TrackResult& result) {
  const Config& config = current.extraction.config();
  const CameraModel& camera = current.extraction.camera();
  const ScratchScope scope(scratch);
  const Se3& T_predicted = reference.prior.T_current_reference;
  current.extraction.lift_lines(current.depth, current_exposure(camera, reference.prior, T_predicted),
                                current.noise, scratch, current.features.lines, result);
  const RowTimeCompensation features = compensate_row_times(camera, reference.prior, T_predicted,
                                                            *reference.features, current.features, scratch);
  {
    const StageTimer timer(config, result, Stage::kMatching);
    const DepthSampler depth = current.depth.with(features.current_exposure);
    track_by_descriptor(view_of(current, depth, features.current_exposure), reference.features->points,
                        features.reference_points, current.features.points, T_predicted, radius_px, scratch,
                        tracks_[0].points);
    LineMatchConfig gates;
    gates.max_offset_px = std::max(gates.max_offset_px, radius_px);
    match_predicted_lines(camera.pinhole, features.current_exposure, reference.features->lines,
                          features.reference_lines, current.features.lines, T_predicted, gates, scratch,
                          tracks_[0].lines);
    tracks_[0].surfaces.clear();  // projecting them needs a good estimate of the motion
  }
  // Without registration this is the whole estimate, otherwise only its start.
  const bool whole = !config.points.registered;
  const NuisanceParameters shared =
      whole ? nuisance_parameters(config.noise, features.current_exposure, current.noise)
            : NuisanceParameters{};
  MotionReferences poses;
  const Indices at = set_poses({&reference, 1}, current.last, poses);
  solve({&features, 1}, poses, current, at, {&T_predicted, shared}, whole ? kFineSolve : kRoughSolve, scratch,
        tracked, result);
  if (tracked.motion.status == StatusCode::kOk)
    tracked.exposure = current_exposure(camera, reference.prior, tracked.motion.T_current_reference);
}

void ReferenceTracking::refine(std::span<const Reference> references, const CurrentFrame& current,
                               const Se3& T_current_base, Arena& scratch, TrackedMotion& tracked,
                               TrackResult& result) {
  const Config& config = current.extraction.config();
  const CameraModel& camera = current.extraction.camera();
  const ScratchScope scope(scratch);
  MotionReferences poses;
  const Indices at = set_poses(references, current.last, poses);
  const MotionsToCurrent motions = motions_to_current(T_current_base, poses);
  const Exposure exposure = current_exposure(camera, references[at.latest].prior, motions[at.latest]);
  const DepthSampler depth = current.depth.with(exposure);
  current.extraction.lift_lines(current.depth, exposure, current.noise, scratch, current.features.lines,
                                result);
  std::array<RowTimeCompensation, kMaxReferences> features;
  for (std::size_t r = 0; r < references.size(); ++r) {
    const Reference& reference = references[r];
    features[r] = compensate_row_times(camera, reference.prior, motions[r], *reference.features,
                                       current.features, scratch);
    const StageTimer timer(config, result, Stage::kMatching);
    track_by_motion(view_of(current, depth, exposure), reference.features->points,
                    features[r].reference_points, motions[r], tracks_[r].points);
    LineMatchConfig gates;
    gates.max_offset_px = kGuidedOffset_px;
    gates.max_angle_rad = kGuidedAngle_rad;
    match_predicted_lines(camera.pinhole, exposure, reference.features->lines, features[r].reference_lines,
                          current.features.lines, motions[r], gates, scratch, tracks_[r].lines);
    track_surfaces(depth, camera.pinhole, current.noise.surfaces, features[r].reference_surfaces, motions[r],
                   tracks_[r].surfaces);
  }
  solve(std::span(features).first(references.size()), poses, current, at,
        {&T_current_base, nuisance_parameters(config.noise, exposure, current.noise), true}, kFineSolve,
        scratch, tracked, result);
  if (tracked.motion.status == StatusCode::kOk)
    tracked.exposure =
        current_exposure(camera, references[at.latest].prior, tracked.motion.motions[at.latest]);
}

}  // namespace plvo
