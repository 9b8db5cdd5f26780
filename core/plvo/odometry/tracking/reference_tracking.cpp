// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/reference_tracking.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "plvo/motion/prior_constraint.hpp"
#include "plvo/odometry/tracking/carried_features.hpp"

namespace plvo {
namespace {

// The first motion only has to lead the second search to within a pixel: a millimetre and a milliradian
// suffice. The second takes its last step without another check when that step is a fifth of the sensor's
// resolution: the remaining error is then less than a twentieth.
constexpr LmOptions kRoughSolve{.max_iterations = 5, .step_tolerance = 3e-4};
constexpr LmOptions kFineSolve{.max_iterations = 20, .decrease_tolerance = 2e-2};

// Limits of the sparse alignment: rounds over a level, and Gauss–Newton steps in each. After a step smaller
// than kAligned (m and rad), another round does not improve the result.
constexpr int kCoarseRounds = 4;
constexpr int kFineRounds = 1;
constexpr int kStepsOfRound = 2;
constexpr double kAligned = 5e-4;

// All references are matched with the same measurements of the current frame: their residuals correlate by ½,
// and n such residuals weigh as n / (1 + (n − 1) / 2) independent ones.
double weight_of_one(std::size_t references) { return 2 / (1 + static_cast<double>(references)); }

// A glance takes every n-th point of a reference, and no more than this many.
constexpr std::size_t kGlancePoints = 64;

// With a propagated prior, the covariance states how uncertain the directions are that vision leaves open.
// The bounds on the SDs are then this large, so that no estimate fails by them.
constexpr double kUnboundedSigma = 1e6;

// Depths contradict the motion if their χ²(3) exceeds this: a test at 0.99.
constexpr double kMostPlausibleOfDepths = 11.3;

// Order of the constraint sets of an estimate: points and lines of each reference.
constexpr std::size_t points_set(std::size_t reference) { return 2 * reference; }
constexpr std::size_t lines_set(std::size_t reference) { return 2 * reference + 1; }
constexpr std::size_t matched_sets(std::size_t references) { return 2 * references; }
static_assert(matched_sets(kMaxReferences) == kMaxConstraintSets);

void count_matches(std::span<ReferenceTracks> tracks, TrackedMotion& tracked) {
  const MotionEstimate& estimate = tracked.motion;
  tracked.points = tracked.lines = {};
  for (std::size_t r = 0; r < tracks.size(); ++r) {
    const int points = estimate.inliers[points_set(r)];
    const int lines = estimate.inliers[lines_set(r)];
    tracks[r].inliers = points + lines;
    tracked.points.matched += static_cast<int>(tracks[r].points.matches.size());
    tracked.lines.matched += static_cast<int>(tracks[r].lines.size());
    tracked.points.inliers += points;
    tracked.lines.inliers += lines;
  }
  tracked.ransac_iterations += estimate.ransac.iterations;
  tracked.lm_iterations += estimate.lm.iterations;
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
  const StageContext& context = current.context;
  const FeatureExtraction& extraction = current.extraction;
  return {context.camera.pinhole,
          context.config.points,
          extraction.pyramid(),
          extraction.mask(),
          depth,
          exposure,
          context.noise,
          context.config.executor,
          context.carried};
}

}  // namespace

std::size_t latest_of(std::span<const Reference> references) {
  std::size_t latest = 0;
  for (std::size_t r = 1; r < references.size(); ++r)
    if (references[r].features->stamp_ns > references[latest].features->stamp_ns) latest = r;
  return latest;
}

// Sets the poses relative to the first reference, and that of the last good frame, which may not be a
// reference.
void ReferenceTracking::set_poses(std::span<const Reference> references, const MotionReference& last,
                                  Association& association) {
  association.references = references.size();
  association.chained = references[0].chained;
  association.latest = latest_of(references);
  const Se3 T_base_first = references[0].pose.T_reference_base.inverse();
  association.poses[kLastGoodPose] = {last.T_reference_base * T_base_first, last.covariance};
  for (std::size_t r = 0; r < references.size(); ++r) {
    if (r > 0) association.poses[r] = references[r].pose;
    if (references[r].timing.reference_is_last) association.last_frame = r;
  }
}

void ReferenceTracking::estimate(const Association& association, const CurrentFrame& current,
                                 const MotionStart& start, const LmOptions& lm, TrackedMotion& tracked) {
  const Config& config = current.context.config;
  Arena& scratch = current.context.scratch;
  const StageTimer timer(current.context, Stage::kMotion);
  const ScratchScope scope(scratch);
  const auto features = std::span(association.features).first(association.references);
  FeatureConstraints constraints = constraints_of(features, tracks_, config.noise, scratch);
  std::array<ConstraintSet*, kMaxConstraintSets> sets{};
  for (std::size_t r = 0; r < features.size(); ++r) {
    sets[points_set(r)] = &constraints.points[r];
    sets[lines_set(r)] = &constraints.lines[r];
  }
  std::array<CostTerm*, kMaxTerms - kMaxConstraintSets> others{};
  std::size_t other_count = 0;
  const PropagatedPrior& sensed = current.predicted.sensed;
  MotionConfig motion_config = config.motion;
  PriorConstraint prior(sensed.T_current_last(), sensed.covariance());
  if (sensed.known() && association.chained) {
    prior.set_reference(association.last_frame, 0);
    others[other_count++] = &prior;
    motion_config.max_sigma_m = motion_config.max_sigma_rad = kUnboundedSigma;
  }
  for (SurfaceConstraints& set : constraints.surfaces)
    if (set.size() > 0) others[other_count++] = &set;

  tracked.exposure = {};
  tracked.observed = {};
  tracked.depth_shift = {};
  const auto matched = std::span(sets).first(matched_sets(features.size()));
  const auto solve = [&](const MotionStart& from) {
    estimate_motion(matched, std::span(others).first(other_count), association.poses, motion_config, lm,
                    config.seed, from, scratch, tracked.motion);
  };
  solve(start);
  const ParallaxCheck* const parallax = current.context.parallax;
  if (parallax != nullptr && tracked.ok() && start.registered && start.search_beside && other_count > 0) {
    const Se3 T_by_parallax = tracked.motion.T_current_reference;
    tracked.depth_shift = depth_shift(constraints.points[0], T_by_parallax, config.noise.shared_depth_m);
    if (parallax->fails() || tracked.depth_shift.chi_square > kMostPlausibleOfDepths) {
      MotionStart again = start;
      again.prediction = &T_by_parallax;
      again.estimated = true;
      // What is seen does not lie at its depth, so surfaces and other sensors decide. If that does not
      // determine the motion, parallax decides again.
      for (const double factor : {1 / kFavoured, kFavoured}) {
        for (ConstraintSet* set : matched) set->scale_weight(factor);
        solve(again);
        if (tracked.ok()) break;
      }
    }
  }
  for (std::size_t r = 0; r < features.size(); ++r) {
    const std::span<const std::uint8_t> points = constraints.points[r].inliers();
    const std::span<const std::uint8_t> lines = constraints.lines[r].inliers();
    std::copy(points.begin(), points.end(), tracks_[r].point_inliers.begin());
    std::copy(lines.begin(), lines.end(), tracks_[r].line_inliers.begin());
  }
  count_matches(std::span(tracks_).first(features.size()), tracked);
  if (tracked.ok() && config.noise.learning_rate > 0) {
    const std::size_t latest = association.latest;
    // The residuals use the poses as known before: with adjusted poses they would be smaller than the noise.
    const Se3 T_current_latest =
        motions_to_current(tracked.motion.T_current_reference, association.poses)[latest];
    tracked.observed = residual_scales(current.context.camera.pinhole, constraints.points[latest],
                                       constraints.lines[latest], T_current_latest, scratch);
    tracked.observed.surfaces = surface_scale(constraints.surfaces[latest], T_current_latest, scratch);
    note_nuisance(start.shared, tracked.motion.shared, tracked.observed);
  }
}

// Not inlined: its variables are no longer on the stack when the motion is solved for.
[[gnu::noinline]] bool ReferenceTracking::align(const Reference& reference, const CurrentFrame& current,
                                                Se3& T_current_reference) const {
  const CameraModel& camera = current.context.camera;
  Arena& scratch = current.context.scratch;
  if (!alignment_.holds(reference.features->stamp_ns)) return false;
  const StageTimer timer(current.context, Stage::kMatching);
  const ScratchScope scope(scratch);
  const PointFeatures& features = reference.features->points;
  const std::span<AlignmentWindow> storage = SparseAlignment::take_windows(scratch);
  const Pyramid& pyramid = current.extraction.pyramid();
  const ImageMask& mask = current.extraction.mask();
  Se3 T = reference.T_current_predicted;
  AlignmentStep step;
  const auto take_rounds = [&](std::span<const AlignmentWindow> windows, int rounds) {
    for (int round = 0; round < rounds; ++round) {
      const ScratchScope exposed(scratch);
      // The effect of a rolling shutter depends on the motion, so it is compensated anew for each better
      // motion.
      const RowTimeCompensation at =
          compensate_row_times_of_points(camera, reference.timing, T, *reference.features, scratch);
      for (int i = 0; i < kStepsOfRound; ++i)
        if (!align_step(windows, at.reference_points, camera.pinhole, at.current_exposure, pyramid, T, step,
                        mask))
          return false;
      if (step.size < kAligned) break;
    }
    return true;
  };
  if (!take_rounds(alignment_.cut_coarse(features, storage, mask), kCoarseRounds) || !step.trusted())
    return false;
  if (!take_rounds(SparseAlignment::cut_fine(features, storage), kFineRounds)) return false;
  T_current_reference = T;
  return true;
}

void ReferenceTracking::associate_by_descriptor(const Reference& reference, const CurrentFrame& current,
                                                const Se3& T_predicted, double radius_px,
                                                Association& association) {
  const StageContext& context = current.context;
  const CameraModel& camera = context.camera;
  set_poses({&reference, 1}, current.predicted.last, association);
  current.extraction.lift_lines(context, current.depth,
                                current_exposure(camera, reference.timing, T_predicted),
                                current.features.lines);
  RowTimeCompensation& features = association.features[0];
  features = compensate_row_times(camera, reference.timing, T_predicted, *reference.features,
                                  current.features, context.scratch);
  const StageTimer timer(context, Stage::kMatching);
  const DepthSampler depth = current.depth.with(features.current_exposure);
  track_by_descriptor(view_of(current, depth, features.current_exposure), reference.features->points,
                      features.reference_points, current.features.points, T_predicted, radius_px,
                      context.scratch, tracks_[0].points);
  LineMatchConfig gates;
  gates.max_offset_px = std::max(gates.max_offset_px, radius_px);
  match_predicted_lines(camera.pinhole, features.current_exposure, reference.features->lines,
                        features.reference_lines, current.features.lines, T_predicted, gates, context.scratch,
                        tracks_[0].lines);
  leave_carried_lines_out({&reference, 1}, current.features.lines, context.carried, {&tracks_[0], 1});
  tracks_[0].surfaces.clear();  // projecting them needs a good estimate of the motion
}

void ReferenceTracking::associate_by_motion(std::span<const Reference> references,
                                            const CurrentFrame& current, const Se3& T_current_base,
                                            Association& association, bool is_whole) {
  const StageContext& context = current.context;
  const CameraModel& camera = context.camera;
  set_poses(references, current.predicted.last, association);
  const MotionsToCurrent motions = motions_to_current(T_current_base, association.poses);
  const Exposure exposure =
      current_exposure(camera, references[association.latest].timing, motions[association.latest]);
  const DepthSampler depth = current.depth.with(exposure);
  if (is_whole || current.features.lines.lifts == 0)
    current.extraction.lift_lines(context, current.depth, exposure, current.features.lines);
  for (std::size_t r = 0; r < references.size(); ++r) {
    const Reference& reference = references[r];
    RowTimeCompensation& features = association.features[r];
    features = compensate_row_times(camera, reference.timing, motions[r], *reference.features,
                                    current.features, context.scratch);
    const StageTimer timer(context, Stage::kMatching);
    const std::size_t stride = is_whole ? 1 : reference.features->points.keypoints.size() / kGlancePoints + 1;
    track_by_motion(view_of(current, depth, exposure), reference.features->points, features.reference_points,
                    motions[r], stride, tracks_[r].points);
    match_predicted_lines(camera.pinhole, exposure, reference.features->lines, features.reference_lines,
                          current.features.lines, motions[r], LineMatchConfig::guided(), context.scratch,
                          tracks_[r].lines);
    if (is_whole)
      track_surfaces(depth, camera.pinhole, context.noise.surfaces, features.reference_surfaces, motions[r],
                     tracks_[r].surfaces);
    else
      tracks_[r].surfaces.clear();
  }
  leave_carried_lines_out(references, current.features.lines, context.carried,
                          std::span(tracks_).first(references.size()));
}

void ReferenceTracking::find(const Reference& reference, const CurrentFrame& current, const Se3& T_predicted,
                             double radius_px, TrackedMotion& tracked) {
  const StageContext& context = current.context;
  const ScratchScope scope(context.scratch);
  Association association;
  associate_by_descriptor(reference, current, T_predicted, radius_px, association);
  // Without registration this is the whole estimate, otherwise only its start.
  const bool whole = !context.config.points.registered;
  const NuisanceParameters shared =
      whole
          ? nuisance_parameters(context.config.noise, association.features[0].current_exposure, context.noise)
          : NuisanceParameters{};
  estimate(association, current, {&T_predicted, shared}, whole ? kFineSolve : kRoughSolve, tracked);
  if (tracked.ok())
    tracked.exposure = current_exposure(context.camera, reference.timing, tracked.motion.T_current_reference);
}

// If the points that stayed at their pixels may mislead the estimate, searches for a motion of the other
// matches. If it is found among those points, they are light that travels with the camera. If the other
// motion explains clearly more than the estimate, it is taken. If neither explains enough, the points that
// stayed are a part of the robot, and the frame has no motion. If both explain about as much, the estimate
// stays and its covariance contains both.
[[gnu::noinline]] void ReferenceTracking::look_beside_stayed(std::span<const Reference> references,
                                                             const CurrentFrame& current,
                                                             const Association& association,
                                                             MotionStart& start, TrackedMotion& tracked) {
  CarriedCells& carried = current.context.carried;
  const auto tracks = std::span(tracks_).first(references.size());
  const StayedMatches stayed = count_stayed(references, tracks, carried);
  const bool rest_is_contradicted = contradicts_rest(stayed, tracked.motion.explained);
  if (!may_be_misled(stayed) && !rest_is_contradicted) return;
  std::array<std::size_t, kMaxReferences> sizes{};
  for (std::size_t r = 0; r < references.size(); ++r) sizes[r] = leave_stayed_out(references[r], tracks[r]);
  const double evidence = tracked.motion.evidence;
  const Se3 motion = tracked.motion.T_current_reference;
  start.estimated = false;
  estimate(association, current, start, kFineSolve, tracked);
  const bool agree =
      tracked.ok() && agree_among_stayed(stayed, references, tracks, current.context.camera, carried);
  const bool explains_more = kComparableShare * tracked.motion.evidence > evidence;
  const bool is_light = agree || depth_contradicts(stayed);
  const bool is_robot = !is_light && rest_is_contradicted && !explains_more;
  if (is_light || is_robot) carried.mark_carried(stayed.cells, is_light);
  if (!agree && (is_light || is_robot)) {
    tracked.motion.status = StatusCode::kNoConsensus;
    return;
  }
  if (agree || explains_more) {
    tracked.motion.is_other = true;
    return;
  }
  Vector6 apart = Vector6::Zero();
  if (tracked.ok() && are_comparable(evidence, tracked.motion.evidence))
    apart = boxminus(tracked.motion.T_current_reference, motion);
  for (std::size_t r = 0; r < references.size(); ++r) tracks[r].points.matches.resize(sizes[r]);
  start.estimated = true;
  estimate(association, current, start, kFineSolve, tracked);
  if (tracked.ok()) tracked.motion.contain(apart);
}

void ReferenceTracking::glance(std::span<const Reference> references, const CurrentFrame& current,
                               const Se3& T_current_base, TrackedMotion& tracked) {
  const StageContext& context = current.context;
  const ScratchScope scope(context.scratch);
  Association association;
  associate_by_motion(references, current, T_current_base, association, false);
  MotionStart start(&T_current_base, {}, true);
  start.search_beside = start.find_shifts = false;
  start.registered = true;
  estimate(association, current, start, kRoughSolve, tracked);
}

void ReferenceTracking::refine(std::span<const Reference> references, const CurrentFrame& current,
                               const Se3& T_current_base, bool leads_on, TrackedMotion& tracked) {
  const StageContext& context = current.context;
  const ScratchScope scope(context.scratch);
  Association association;
  associate_by_motion(references, current, T_current_base, association, true);
  const std::size_t latest = association.latest;
  const NuisanceParameters shared =
      nuisance_parameters(context.config.noise, association.features[latest].current_exposure, context.noise);
  MotionStart start{&T_current_base, shared, true};
  start.registered = true;
  start.find_shifts_of_other = !leads_on;
  estimate(association, current, start, kFineSolve, tracked);
  if (tracked.ok()) look_beside_stayed(references, current, association, start, tracked);
  if (tracked.ok())
    tracked.exposure =
        current_exposure(context.camera, references[latest].timing, tracked.motion.motions[latest]);
}

// A TrackedMotion holds numbers alone, so its bytes are its value.
void ReferenceTracking::keep(const TrackedMotion& tracked, Arena& scratch, KeptEstimate*& kept) const {
  if (kept == nullptr) {
    kept = scratch.take<KeptEstimate>("kept estimate", 1).data();
    kept->matches = scratch.take<std::byte>("kept matches", matches_.size());
    assert(!scratch.exhausted());  // reserve()
  }
  std::memcpy(kept->tracked, &tracked, sizeof tracked);
  std::memcpy(kept->tracks, &tracks_, sizeof tracks_);
  std::memcpy(kept->matches.data(), matches_.data(), matches_.size());
}

void ReferenceTracking::put_back(const KeptEstimate& kept, TrackedMotion& tracked) {
  const int ransac_iterations = tracked.ransac_iterations;
  const int lm_iterations = tracked.lm_iterations;
  std::memcpy(static_cast<void*>(&tracked), kept.tracked, sizeof tracked);
  tracked.ransac_iterations = ransac_iterations;
  tracked.lm_iterations = lm_iterations;
  std::memcpy(static_cast<void*>(&tracks_), kept.tracks, sizeof tracks_);
  std::memcpy(matches_.data(), kept.matches.data(), matches_.size());
}

}  // namespace plvo
