// SPDX-License-Identifier: Apache-2.0
// Part of the odometry: relocalisation after a loss, when the view of a kept keyframe comes back. Descriptors
// are matched over the whole image, whatever the predicted pose; the motion is then registered and judged as
// usual. It is accepted under two conditions. It finds the share of the keyframe's features that a keyframe
// needs to be kept. And the resulting pose lies within the process noise of the unobserved motion: this
// rejects a similar view elsewhere.
#include <algorithm>

#include "plvo/math/chi_square.hpp"
#include "plvo/math/cholesky.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo {
namespace {

// Probability with which a correct pose passes the test.
constexpr double kPlausible = 0.9999;

// Not inlined: its matrices would otherwise stay on the stack while the motion is solved for.
[[gnu::noinline]] bool agree(const PoseWithCovariance& reference, const MotionEstimate& motion,
                             const PoseWithCovariance& b) {
  const PoseWithCovariance a = advance(reference, motion.T_current_reference, motion.C_H);
  Cholesky<6> cholesky;
  if (!cholesky.factor(a.covariance + b.covariance)) return false;
  const Vector6 apart = boxminus(a.T_world_camera, b.T_world_camera);
  return cholesky.solve_lower(apart).squaredNorm() <= chi_square_quantile(6, kPlausible);
}

}  // namespace

// Matches the current frame with a kept keyframe. features: of the current frame, which moves at this
// velocity; believed: its pose without the relocalisation.
bool Odometry::recognise(int slot, FrameFeatures& features, const Vector6& velocity,
                         const DepthSampler& depth, const PoseWithCovariance& believed,
                         TrackedMotion& tracked, TrackResult& result) {
  PairPrior prior;
  prior.velocity = velocity;
  prior.velocity_known = true;
  prior.reference_velocity = window_[slot].velocity;
  prior.reference_velocity_known = window_[slot].motion_ns > 0;
  prior.reference_is_last = false;
  prior.depth_after_colour_s = depth_after_colour_s_;
  const PropagatedPrior no_prior;
  const MotionReference no_last_frame;
  const CurrentFrame current{features, memory_.extraction, depth, noise_, no_prior, no_last_frame};
  const Reference reference{&window_[slot].features, prior, {}};
  memory_.extraction.describe_points(arena_, features.points, result);
  const double anywhere_px = std::max(camera().width, camera().height);
  memory_.tracking.find(reference, current, anywhere_px, arena_, tracked, result);
  if (tracked.motion.status == StatusCode::kOk && config().points.registered) {
    const Se3 T_current_reference = tracked.motion.T_current_reference;
    memory_.tracking.refine({&reference, 1}, current, T_current_reference, arena_, tracked, result);
  }
  return tracked.motion.status == StatusCode::kOk &&
         still_seen(slot, 0, config().references.keyframe_inlier_ratio) &&
         agree(window_[slot].pose, tracked.motion, believed);
}

// Called before tracking starts anew: takes up the kept keyframe again if its view is back.
bool Odometry::resume(const DepthSampler& depth, const MotionPrior& prior, TrackedMotion& tracked,
                      TrackResult& result) {
  if (window_.kept().empty()) return false;
  const int slot = window_.kept().latest();
  PoseWithCovariance believed = window_.last_frame().pose;
  add_process_noise(result.stamp_ns, believed.covariance);
  TrackResult trial = result;
  // The camera is taken to stand still: its velocity before the loss is out of date.
  const bool found =
      recognise(slot, window_.current_frame().features, Vector6::Zero(), depth, believed, tracked, trial);
  result.stage_ns = trial.stage_ns;
  if (!found) return false;
  result = trial;
  window_.resume(slot);
  result.reference_stamp_ns = window_[slot].features.stamp_ns;
  accept(depth, tracked, prior, result);
  result.returned = true;
  return true;
}

// Tracking has resumed with a new start, whose pose was not observed. If the view of a kept keyframe is back,
// all poses are moved so that the pose of this frame is the one that follows from that keyframe.
// tracked: holds the frame's own motion, which is accepted and no longer needed; it is overwritten.
void Odometry::relocalise(const DepthSampler& depth, TrackedMotion& tracked, TrackResult& result) {
  if (window_.kept().empty()) return;
  if (!relocalisation_is_due()) {
    ++frames_since_relocalisation_;
    return;
  }
  frames_since_relocalisation_ = 0;
  const int slot = window_.kept().next();
  Window::Frame& last = window_.last_frame();  // the frame just tracked
  // Separate: the counts of the frame are those of its own tracking
  TrackResult trial;
  trial.stage_ns = result.stage_ns;
  const bool found =
      recognise(slot, last.features, last.velocity, depth, window_.last_frame().pose, tracked, trial);
  result.stage_ns = trial.stage_ns;
  if (!found) return;
  move_to_relocalised_pose(slot, tracked.motion);
  report(window_.last_frame().pose, last.velocity, result);
  result.returned = true;
}

// Moves all poses so that the last frame is where `motion` leads from the kept keyframe. Not inlined: its
// matrices would otherwise stay on the stack during the search for that keyframe.
[[gnu::noinline]] void Odometry::move_to_relocalised_pose(int slot, const MotionEstimate& motion) {
  const PoseWithCovariance pose = advance(window_[slot].pose, motion.T_current_reference, motion.C_H);
  const MotionReference from = window_.from_keyframe(window_.last());
  window_.move_last(pose, inverse_covariance(from.T_reference_base, window_.last_motion().total()));
  window_.kept().drop(slot);
}

}  // namespace plvo
