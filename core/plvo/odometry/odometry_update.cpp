// SPDX-License-Identifier: Apache-2.0
// Part of the odometry: the window, the world and the learnt noise after a frame, and its result. Also poses
// that the caller sets.
#include "plvo/math/covariance.hpp"
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/odometry/stamp_error.hpp"
#include "plvo/odometry/tracking/carried_features.hpp"
#include "plvo/odometry/tracking/landmark_records.hpp"

namespace plvo {
namespace {

// Farther than any place on Earth, in any system of coordinates; a double still resolves 0.01 µm there.
constexpr double kFarthestPose_m = 1e8;

void count_matches(const MatchCounts& matches, FeatureCounts& counts) {
  counts.matched = matches.matched;
  counts.inliers = matches.inliers;
}

}  // namespace

[[gnu::noinline]] TrackResult Odometry::update(const CurrentFrame& frame, const Decision& decision,
                                               const MotionPrior& prior, const TrackedMotion& tracked) {
  view_slot_ = window_.current();
  memory_.views.show(frame.features.lines);
  last_stamp_ns_ = frame.stamp_ns();
  has_stamp_ = true;
  propagated_prior_ = frame.predicted.sensed;
  switch (decision.outcome) {
    case Decision::Outcome::kTrack: return accept(frame, decision, prior, tracked);
    case Decision::Outcome::kLose: return lose(frame, decision, prior, tracked);
    default: return start(frame, decision, prior, tracked);
  }
}

[[gnu::noinline]] TrackResult Odometry::accept(const CurrentFrame& frame, const Decision& decision,
                                               const MotionPrior& prior, const TrackedMotion& tracked) {
  const MotionEstimate& motion = tracked.motion;
  const Window::Kept& kept = decision.kept;
  if (!tracked.relocalised) show_tracks();
  // A frame that has come back to an earlier keyframe was not matched with the references.
  const std::span<const Reference> matched =
      tracked.relocalised ? std::span<const Reference>() : frame.predicted.references();
  for (std::size_t r = 0; r < matched.size(); ++r)
    if (FrameFeatures* features = window_.find(matched[r].features); features != nullptr)
      note_records(memory_.tracking.tracks(r), *features);
  if (!kept.recent) {
    if (!matched.empty())
      vote_for_carried(frame, matched[0], memory_.tracking.tracks(0), motion.T_current_reference, carried_);
    make_reference(frame, tracked.exposure, !kept.keyframe);
    inherit_records(matched, memory_.tracking, frame);
  }
  window_.remove_carried(carried_);
  TrackResult result = begin_result(frame, tracked);
  result.state = TrackState::kTracking;
  result.restarted = tracked.restarted;
  result.status = tracked.restarted ? decision.status : tell_carried();
  result.reference_stamp_ns = window_[window_.keyframe()].features.stamp_ns;
  result.T_camera_reference = motion.T_current_reference;
  const Matrix6 common_mode = common_mode_error(motion.references, window_.recent_motion().common_mode,
                                                config_->noise.common_mode_share);
  window_.set_motion({motion.C_H, common_mode});
  const Matrix6 covariance = window_.last_motion().total();
  PoseWithCovariance from = window_[window_.keyframe()].pose;
  PoseWithCovariance pose = advance(from, motion.T_current_reference, covariance);
  if (prior.gravity) {
    gravity_.read(*prior.gravity, from, pose);
    window_.move_keyframe(from);
  }
  window_.set_pose(window_.current(), pose);
  window_.set_velocity(elapsed_ns(window_.last_frame().features.stamp_ns, frame.stamp_ns()));
  const Vector6& velocity = window_.current_frame().velocity.value;
  result.motion_covariance =
      covariance + stamp_covariance_of_motion(motion.T_current_reference, velocity,
                                              window_[window_.keyframe()].velocity.value,
                                              camera_.stamp_sigma_s);
  is_lost_ = false;
  propagated_prior_.restart();
  learn(config_->noise, tracked.observed, noise_);
  window_.advance(kept, config_->references.policy == ReferencePolicy::kWindow && config_->points.registered);
  note_depth();
  result.relocalised = tracked.relocalised;
  report(window_.last_frame().pose, window_.last_frame().velocity.value, result);
  return result;
}

// A status that says where in the image something travels with the camera. It is given when this is found,
// and again when it has grown to more than twice as many cells.
Status Odometry::tell_carried() {
  if (carried_.count() <= 2 * carried_told_) return {};
  carried_told_ = carried_.count();
  const PixelBounds bounds = carried_.bounds();
  return Status(StatusCode::kOk,
                "a part of the image travels with the camera; its points are left out: columns ")
      .append(bounds.left)
      .append(" to ")
      .append(bounds.right - 1)
      .append(", rows ")
      .append(bounds.top)
      .append(" to ")
      .append(bounds.bottom - 1);
}

// Makes the current frame the keyframe and the last good frame, without a motion before it. A frame that
// cannot be that is left out, and the odometry waits for the next one.
[[gnu::noinline]] TrackResult Odometry::start(const CurrentFrame& frame, const Decision& decision,
                                              const MotionPrior& prior, const TrackedMotion& tracked) {
  if (decision.new_world) forget_world();
  TrackResult result = begin_result(frame, tracked);
  result.state = TrackState::kInitialising;
  result.status = decision.status;
  if (decision.outcome == Decision::Outcome::kWait) {
    report(window_.current_frame().pose, Vector6::Zero(), result);
    return result;
  }
  PoseWithCovariance pose = decision.pose;
  if (decision.gravity == Decision::Gravity::kLevel) {
    gravity_.level(*prior.gravity, pose);
  } else if (decision.gravity == Decision::Gravity::kRead && prior.gravity) {
    PoseWithCovariance itself = pose;  // the camera is not chained to an earlier pose
    gravity_.read(*prior.gravity, itself, pose);
  }
  make_reference(frame, frame.predicted.exposure, true);
  result.restarted = window_.has_last();
  window_.start(pose);
  report(window_.last_frame().pose, Vector6::Zero(), result);
  result.reference_stamp_ns = frame.stamp_ns();
  is_lost_ = false;
  propagated_prior_.restart();
  note_depth();
  if (!world_is_lost_) return result;
  world_is_lost_ = false;
  result.status = {StatusCode::kOk,
                   "a new world starts: where the camera is in the one before is not known any more"};
  return result;
}

[[gnu::noinline]] TrackResult Odometry::lose(const CurrentFrame& frame, const Decision& decision,
                                             const MotionPrior& prior, const TrackedMotion& tracked) {
  TrackResult result = begin_result(frame, tracked);
  result.state = TrackState::kLost;
  result.status = decision.status;
  if (window_.has_keyframe()) result.reference_stamp_ns = window_[window_.keyframe()].features.stamp_ns;
  const Window::Frame& last = window_.last_frame();
  if (frame.predicted.sensed.known()) {
    const SensedPose sensed = sensed_pose(frame, prior);
    result.state = TrackState::kPredicted;
    result.reference_stamp_ns = window_[window_.base()].features.stamp_ns;
    result.T_camera_reference = sensed.T_camera_reference;
    result.motion_covariance = sensed.motion_covariance;
    report(sensed.pose, last.velocity.value, result);
  } else {
    report(last.pose, last.velocity.value, result);
  }
  note_loss(frame, decision, prior);
  return result;
}

// Prepares the features and the image of the current frame for the next ones.
void Odometry::make_reference(const CurrentFrame& frame, const Exposure& exposure, bool keyframe) {
  frame.find_points();
  if (keyframe) frame.describe_points();
  memory_.extraction.lift(frame.context, frame.depth.with(exposure), frame.features);
  memory_.tracking.keep_image(memory_.extraction.pyramid(), frame.stamp_ns());
}

// The tracks of the latest reference.
void Odometry::show_tracks() {
  const bool both = window_.has_recent();
  memory_.views.show_tracks(window_[both ? window_.recent() : window_.keyframe()].features,
                            memory_.tracking.tracks(both ? 1 : 0));
}

// A result with the counts of the frame.
TrackResult Odometry::begin_result(const CurrentFrame& frame, const TrackedMotion& tracked) {
  if (frame.features.points.looked_for) points_found_ = count(frame.features.points);
  TrackResult result;
  result.stamp_ns = frame.stamp_ns();
  result.feature_step = budget_.step();
  result.points = points_found_;
  result.lines = count(frame.features.lines);
  count_matches(tracked.points, result.points);
  count_matches(tracked.lines, result.lines);
  result.ransac_iterations = tracked.ransac_iterations;
  result.lm_iterations = tracked.lm_iterations;
  return result;
}

// Reports a pose at its stamp, with the error of the stamp.
void Odometry::report(const PoseWithCovariance& pose, const Vector6& velocity, TrackResult& result) const {
  result.world = world_;
  result.T_world_camera = pose.T_world_camera;
  result.pose_covariance =
      pose.covariance + stamp_covariance_of_pose(pose.T_world_camera, velocity, camera_.stamp_sigma_s);
}

// Forgets all poses and what depends on them; the learnt noise stays. The next usable frame is the first of a
// new world. A world without a pose keeps its number for that frame.
void Odometry::forget_world() {
  if (window_.has_last()) ++world_;
  window_.clear();
  frames_since_relocalisation_ = 0;
  start_is_set_ = false;
  propagated_prior_ = PropagatedPrior();
  gravity_.forget();
  is_lost_ = has_depth_pose_ = depth_has_stopped_ = false;
  world_is_lost_ = true;
}

Status Odometry::set_pose(const Se3& T_world_camera, const Matrix6& covariance) {
  if (!config_) return {StatusCode::kInvalidArgument, "set_pose() before a successful init()"};
  if (!T_world_camera.is_finite() || !is_rotation(T_world_camera.R) ||
      !(T_world_camera.t.cwiseAbs().maxCoeff() <= kFarthestPose_m))
    return {StatusCode::kInvalidArgument,
            "set_pose: the pose must be finite, its R a rotation matrix, its position within 1e8 m"};
  if (!is_covariance(covariance))
    return {StatusCode::kInvalidArgument,
            "set_pose: the covariance must be finite, symmetric and without negative eigenvalues"};
  gravity_.forget();
  PoseWithCovariance pose;
  pose.T_world_camera = {renormalise(T_world_camera.R), T_world_camera.t};
  pose.covariance = covariance;
  (void)settle(pose);  // finite, as checked above
  start_is_set_ = true;
  world_is_lost_ = false;
  window_.kept().clear();  // their poses belong to the old world
  window_.drop_lost();
  has_depth_pose_ = false;
  // The keyframe moves with the last frame: the motion between them does not change.
  if (window_.has_last())
    window_.move_last(pose, Matrix6::Zero());
  else
    window_.set_pose(window_.current(), pose);
  return {};
}

}  // namespace plvo
