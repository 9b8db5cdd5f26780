// SPDX-License-Identifier: Apache-2.0
// Part of the odometry: the window, the world and the learnt noise after a frame, and its result. Also poses
// that the caller sets.
#include "plvo/math/covariance.hpp"
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/odometry/recovery.hpp"
#include "plvo/odometry/stamp_error.hpp"
#include "plvo/odometry/tracking/carried_features.hpp"
#include "plvo/odometry/tracking/landmark_records.hpp"

namespace plvo {
namespace {

// Farther than any place on Earth, in any system of coordinates; a double still resolves 0.01 µm there.
constexpr double kFarthestPose_m = 1e8;

// The counts of a frame. points: those of the latest frame in which points were searched.
void count_features(const FeatureCounts& points, const CurrentFrame& frame, const TrackedMotion& tracked,
                    TrackResult& result) {
  result.points = points;
  result.points.matched = tracked.points.matched;
  result.points.inliers = tracked.points.inliers;
  result.lines = count(frame.features.lines);
  result.lines.matched = tracked.lines.matched;
  result.lines.inliers = tracked.lines.inliers;
}

// A status that says where in the image something travels with the camera.
Status tell_carried(CarriedCells& carried) {
  if (!carried.take_news()) return {};
  const PixelBounds bounds = carried.bounds();
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

// A status that says whether depth contradicts parallax, or else whether points, lines and surfaces disagree.
Status tell_disagreement(bool parallax_fails, double inflation) {
  constexpr double kWorthSaying = 100;  // the SD is more than ten times as large
  Status status;
  if (parallax_fails)
    status.append("depth contradicts parallax (a mirror?); the motion follows depth");
  else if (inflation > kWorthSaying)
    status.append("points, lines and surfaces disagree about the motion: its covariance is multiplied by ")
        .append(static_cast<std::ptrdiff_t>(inflation));
  return status;
}

// Prepares the features and the image of the current frame for the next ones.
void make_reference(const CurrentFrame& frame, const Exposure& exposure, bool is_keyframe,
                    ReferenceTracking& tracking) {
  frame.lift_as_reference(exposure, is_keyframe);
  tracking.keep_image(frame.extraction.pyramid(), frame.stamp_ns());
}

}  // namespace

[[gnu::noinline]] TrackResult Odometry::update(const CurrentFrame& frame, const Decision& decision,
                                               const TrackedMotion& tracked) {
  view_slot_ = window_.current();
  memory_.views.show(frame.features.lines);
  last_stamp_ns_ = frame.stamp_ns();
  propagated_prior_ = frame.predicted.sensed;
  if (decision.depth_has_stopped)
    depth_.stop();
  else if (tracked.gives_up)
    window_.give_up();
  TrackResult result;
  switch (decision.outcome) {
    case Decision::Outcome::kTrack: accept(frame, decision, tracked, result); break;
    case Decision::Outcome::kLose: lose(frame, decision, result); break;
    default: start(frame, decision, result);
  }
  if (frame.features.points.looked_for) points_found_ = count(frame.features.points);
  count_features(points_found_, frame, tracked, result);
  result.stamp_ns = frame.stamp_ns();
  result.world = world_;
  result.feature_step = budget_.step();
  return result;
}

[[gnu::noinline]] void Odometry::accept(const CurrentFrame& frame, const Decision& decision,
                                        const TrackedMotion& tracked, TrackResult& result) {
  if (tracked.base.kind == MotionBase::Kind::kLost) window_.go_on_from_lost();
  if (tracked.base.kind == MotionBase::Kind::kKept) window_.resume(tracked.base.slot);
  const MotionEstimate& motion = tracked.motion;
  const Window::Kept& kept = decision.kept;
  ReferenceTracking& tracking = memory_.tracking;
  result.relocalised = tracked.base.kind == MotionBase::Kind::kKept;
  // A frame that has come back to an earlier keyframe was not matched with the references.
  const Window::References references = result.relocalised ? Window::References() : window_.references();
  const std::span<const int> matched = references.span();
  for (std::size_t r = 0; r < matched.size(); ++r) {
    if (r == (window_.has_recent() ? 1 : 0))
      memory_.views.show_tracks(window_[matched[r]].features, tracking.tracks(r));
    note_records(tracking.tracks(r), window_[matched[r]].features);
  }
  if (!kept.recent) {
    if (!matched.empty())
      vote_for_carried(frame, window_[matched[0]].features.points, tracking.tracks(0),
                       motion.T_current_reference, carried_);
    make_reference(frame, tracked.exposure, !kept.keyframe, tracking);
    inherit_records(window_, matched, tracking, frame);
  }
  window_.remove_carried(carried_);
  result.state = TrackState::kTracking;
  result.restarted = tracked.base.kind == MotionBase::Kind::kLost;
  result.status = result.restarted ? decision.status : tell_carried(carried_);
  result.reference_stamp_ns = window_[window_.keyframe()].features.stamp_ns;
  result.T_camera_reference = motion.T_current_reference;
  const Matrix6 common_mode = common_mode_error(motion.references, window_.recent_motion().common_mode,
                                                config_->noise.common_mode_share);
  window_.set_motion({motion.C_H, common_mode});
  // Where kinds of landmarks disagree, more is reported, but not fed back: references are weighed against
  // each other by what they measure.
  const bool learns = config_->noise.learning_rate > 0;
  const OfEachKind shifts = learns ? motion.shifts : OfEachKind(OfEachKind::Zero());
  Matrix6 covariance = window_.last_motion().total();
  PoseWithCovariance from = window_[window_.keyframe()].pose;
  PoseWithCovariance pose = advance(from, motion.T_current_reference, covariance, shifts);
  const Window::Frame& last = window_.last_frame();
  const std::int64_t since_last_ns = elapsed_ns(last.features.stamp_ns, frame.stamp_ns());
  const double since_last_s = static_cast<double>(since_last_ns) * 1e-9;
  if (learns && !result.relocalised && !result.restarted)
    disagreement_.note(last.pose, pose, motion.T_current_reference, motion.C_H, since_last_s);
  result.disagreement = disagreement_.inflation();
  pose.covariance += transform_covariance(derivative_by_motion(pose, motion.T_current_reference),
                                          (result.disagreement - 1) * covariance);
  covariance *= result.disagreement;
  parallax_.note(tracked.depth_shift, since_last_s);
  if (result.status.message()[0] == '\0')
    result.status = tell_disagreement(parallax_.fails(), result.disagreement);
  if (frame.prior.gravity) {
    gravity_.read(*frame.prior.gravity, from, pose);
    window_.move_keyframe(from);
  }
  window_.set_pose(window_.current(), pose);
  window_.set_velocity(since_last_ns);
  const Vector6& velocity = window_.current_frame().velocity.value;
  result.motion_covariance =
      covariance + stamp_covariance_of_motion(motion.T_current_reference, velocity,
                                              window_[window_.keyframe()].velocity.value,
                                              camera_.stamp_sigma_s);
  learn(config_->noise, tracked.observed, noise_);
  window_.advance(kept, config_->references.policy == ReferencePolicy::kWindow && config_->points.registered);
  note_pose(result);
}

// Makes the current frame the keyframe and the last good frame, without a motion before it. If the
// frame cannot start a trajectory, it is left out, and the odometry waits for the next one.
[[gnu::noinline]] void Odometry::start(const CurrentFrame& frame, const Decision& decision,
                                       TrackResult& result) {
  if (decision.new_world) forget_world();
  result.state = TrackState::kInitialising;
  result.status = decision.status;
  PoseWithCovariance pose = decision.pose;
  if (decision.outcome == Decision::Outcome::kWait) {
    report_pose(window_.current_frame().pose, Vector6::Zero(), camera_.stamp_sigma_s, result);
    return;
  }
  const std::optional<GravityPrior>& reading = frame.prior.gravity;
  if (decision.gravity == Decision::Gravity::kLevel) {
    gravity_.level(*reading, pose);
  } else if (decision.gravity == Decision::Gravity::kRead && reading) {
    PoseWithCovariance itself = pose;  // the camera is not chained to an earlier pose
    gravity_.read(*reading, itself, pose);
  }
  make_reference(frame, frame.predicted.exposure, true, memory_.tracking);
  result.restarted = window_.has_last();
  window_.start(pose);
  result.reference_stamp_ns = frame.stamp_ns();
  note_pose(result);
  if (!world_is_lost_) return;
  world_is_lost_ = false;
  result.status = {StatusCode::kOk, "a new world starts: the pose in the previous world is no longer known"};
}

// The frame, now the last one of the window, has a pose from its images.
void Odometry::note_pose(TrackResult& result) {
  const Window::Frame& last = window_.last_frame();
  report_pose(last.pose, last.velocity.value, camera_.stamp_sigma_s, result);
  lost_since_ns_.reset();
  propagated_prior_.restart();
  if (!window_.T_world_depth() || !depth_.is_repeated()) window_.note_depth();
}

// Reports the last good pose or, if the priors give one, the predicted pose. A usable frame is
// kept, so that the next frame can be matched with it. It gets the predicted pose or, without one,
// the last good pose with the covariance of the unobserved motion since then.
[[gnu::noinline]] void Odometry::lose(const CurrentFrame& frame, const Decision& decision,
                                      TrackResult& result) {
  result.state = TrackState::kLost;
  result.status = decision.status;
  if (window_.has_keyframe()) result.reference_stamp_ns = window_[window_.keyframe()].features.stamp_ns;
  const Window::Frame& last = window_.last_frame();
  SensedPose sensed;
  sensed.pose = last.pose;
  if (frame.predicted.sensed.known()) {
    sensed = sensed_pose(window_, gravity_, frame);
    result.state = TrackState::kPredicted;
    result.reference_stamp_ns = window_[window_.base()].features.stamp_ns;
    result.T_camera_reference = sensed.T_camera_reference;
    result.motion_covariance = sensed.motion_covariance;
  }
  report_pose(sensed.pose, last.velocity.value, camera_.stamp_sigma_s, result);
  if (!lost_since_ns_) lost_since_ns_ = frame.stamp_ns();
  window_.drop_lost();
  if (!decision.usable || !window_.can_keep_lost()) return;
  frame.lift_as_reference(frame.predicted.exposure, true);
  frame.extraction.lift_lines(frame.context, frame.depth, frame.predicted.exposure, frame.features.lines);
  window_.keep_lost(result.state == TrackState::kPredicted
                        ? sensed.pose
                        : unobserved_pose(window_, config_->references, frame.stamp_ns()));
}

// Called while tracking goes on after a start whose pose was not observed. If the view of a kept
// keyframe is back, all poses are moved: this frame then has the pose that follows from that
// keyframe. The result says so. tracked: the motion of this frame, which has been accepted and is
// not needed any more; it is overwritten.
[[gnu::noinline]] void Odometry::relocalise(const CurrentFrame& frame, TrackedMotion& tracked,
                                            TrackResult& result) {
  if (!relocalisation_.take(window_.kept())) return;
  const int slot = window_.next_kept();
  const Window::Frame& last = window_.last_frame();  // the frame just tracked
  if (!recognise(window_[slot], frame, last.velocity.value, last.pose, memory_.tracking, tracked)) return;
  window_.relocalise(slot, tracked.motion);
  result.relocalised = true;
  report_pose(last.pose, last.velocity.value, camera_.stamp_sigma_s, result);
}

// Forgets all poses and what depends on them; the learnt noise stays. The next usable frame is the first of a
// new world. If the present world has no pose yet, the new world has the same number.
void Odometry::forget_world() {
  if (window_.has_last()) ++world_;
  window_.clear();
  relocalisation_.forget();
  start_is_set_ = false;
  propagated_prior_ = PropagatedPrior();
  gravity_.forget();
  disagreement_ = {};
  parallax_ = {};
  lost_since_ns_.reset();
  depth_.forget_stop();
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
  window_.change_world(pose);
  return {};
}

}  // namespace plvo
