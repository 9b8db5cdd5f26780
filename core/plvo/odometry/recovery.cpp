// SPDX-License-Identifier: Apache-2.0
// Part of the odometry: relocalisation after a loss, when the view of a kept keyframe comes back. Descriptors
// are matched over the whole image, whatever the predicted pose; the motion is then registered and judged as
// usual. It is accepted under two conditions. It finds the share of the keyframe's features that a keyframe
// needs to be kept. And the resulting pose lies within the process noise of the unobserved motion: this
// rejects a similar view elsewhere.
#include <algorithm>

#include "plvo/math/mahalanobis.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo {
namespace {

// Not inlined: its matrices would otherwise stay on the stack while the motion is solved for.
[[gnu::noinline]] bool agree(const PoseWithCovariance& reference, const MotionEstimate& motion,
                             const PoseWithCovariance& b) {
  const PoseWithCovariance a = advance(reference, motion.T_current_reference, motion.C_H);
  const Vector6 apart = boxminus(a.T_world_camera, b.T_world_camera);
  return mahalanobis_squared<6>(apart, a.covariance + b.covariance) <= kMostPlausibleMotion;
}

}  // namespace

// Matches the current frame, which moves at this velocity, with a kept keyframe. believed: its pose without
// the relocalisation.
bool Odometry::recognise(int slot, const CurrentFrame& frame, const Vector6& velocity,
                         const PoseWithCovariance& believed, TrackedMotion& tracked) {
  Reference kept;
  kept.features = &window_[slot].features;
  kept.prior.recent = velocity;
  kept.prior.reference = window_[slot].velocity;
  kept.prior.reference_is_last = false;
  kept.prior.depth_after_colour_s = frame.predicted.depth_after_colour_s;
  kept.chained = false;
  frame.describe_points();
  const double anywhere_px = std::max(camera_.width, camera_.height);
  memory_.tracking.find(kept, frame, Se3{}, anywhere_px, tracked);
  if (tracked.ok() && config_->points.registered) {
    const Se3 T_current_reference = tracked.motion.T_current_reference;
    memory_.tracking.refine({&kept, 1}, frame, T_current_reference, tracked);
  }
  return tracked.ok() && still_seen(slot, 0, config_->references.keyframe_inlier_ratio) &&
         agree(window_[slot].pose, tracked.motion, believed);
}

// Called before tracking starts anew: takes up the kept keyframe again if its view is back. Otherwise there
// is no motion, and the lines are lifted without one.
[[gnu::noinline]] void Odometry::resume(const CurrentFrame& frame, TrackedMotion& tracked) {
  tracked.relocalised = false;
  if (!window_.kept().empty()) {
    const int slot = window_.kept().latest();
    // The camera is taken to stand still: its velocity before the loss is out of date.
    tracked.relocalised = recognise(slot, frame, Vector6::Zero(), unobserved_pose(frame.stamp_ns()), tracked);
    if (tracked.relocalised) window_.resume(slot);
  }
  if (tracked.relocalised) return;
  tracked.motion.status = StatusCode::kNoConsensus;
  tracked.points = tracked.lines = {};
  tracked.ransac_iterations = tracked.lm_iterations = 0;
  memory_.extraction.lift_lines(frame.context, frame.depth, frame.predicted.exposure, frame.features.lines);
}

// Tracking has resumed with a new start, whose pose was not observed. If the view of a kept keyframe is back,
// all poses are moved so that the pose of this frame is the one that follows from that keyframe, and the
// result states it. tracked: holds the frame's own motion, which is accepted and no longer needed; it is
// overwritten.
[[gnu::noinline]] void Odometry::relocalise(const CurrentFrame& frame, TrackedMotion& tracked,
                                            TrackResult& result) {
  if (window_.kept().empty()) return;
  if (!relocalisation_is_due()) {
    ++frames_since_relocalisation_;
    return;
  }
  frames_since_relocalisation_ = 0;
  const int slot = window_.kept().next();
  const Window::Frame& last = window_.last_frame();  // the frame just tracked
  if (!recognise(slot, frame, last.velocity.value, last.pose, tracked)) return;
  move_to_relocalised_pose(slot, tracked.motion);
  result.relocalised = true;
  report(last.pose, last.velocity.value, result);
}

// Moves all poses so that the last frame is where `motion` leads from the kept keyframe. Not inlined: its
// matrices would otherwise stay on the stack during the search for that keyframe.
[[gnu::noinline]] void Odometry::move_to_relocalised_pose(int slot, const MotionEstimate& motion) {
  const PoseWithCovariance pose = advance(window_[slot].pose, motion.T_current_reference, motion.C_H);
  const MotionReference from = window_.from_keyframe(window_.last());
  window_.move_last(pose, inverse_covariance(from.T_reference_base, window_.last_motion().total()));
  window_.kept().drop(slot);
  has_depth_pose_ = false;
}

}  // namespace plvo
