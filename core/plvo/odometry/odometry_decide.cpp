// SPDX-License-Identifier: Apache-2.0
// Part of the odometry: what the outcome of a frame is, and why.
#include "plvo/math/covariance.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/odometry/recovery.hpp"

namespace plvo {
namespace {

// A frame with fewer 3D points and lines than this cannot start a trajectory.
constexpr int kMinStartFeatures = 20;
// A recent frame is matched while at least this share of its features are inliers.
constexpr double kRecentInlierRatio = 0.5;
// The same for the older keyframe of kWindow. It shows another part of the scene than the keyframe, so fewer
// of its features are in view.
constexpr double kOlderInlierRatio = 0.2;

Status hardly_anything(StatusCode code, const char* first_word, const FrameFeatures& features) {
  return Status(code, first_word)
      .append("hardly anything to see (dark, blurred, bare, or no depth); keypoints: ")
      .append(features.points.candidates)
      .append(", 3D points and lines: ")
      .append(features.count_3d());
}

// States why no motion was found, and what would help.
Status explain_loss(const FrameFeatures& features, const TrackedMotion& tracked, const char* first_word) {
  const StatusCode code = tracked.motion.status;
  if (features.count_3d() < kMinStartFeatures) return hardly_anything(code, first_word, features);
  const int matched = tracked.points.matched + tracked.lines.matched;
  Status status(code, first_word);
  switch (code) {
    case StatusCode::kTooFewFeatures:
      return status.append("too few features of the reference were found again: ").append(matched);
    case StatusCode::kNoConsensus:
      return status.append("the matches do not agree on one motion; matches: ").append(matched);
    case StatusCode::kDegenerate:
      return status.append("the features do not determine every direction of motion; inliers: ")
          .append(tracked.inliers());
    default: return status.append("the motion did not converge; inliers: ").append(tracked.inliers());
  }
}

// Whether the depth image is an old one, and the camera has moved since it came.
[[gnu::noinline]] bool is_too_old(const DepthStream& depth, const Window& window,
                                  const TrackedMotion& tracked) {
  const std::optional<Se3>& T_world_depth = window.T_world_depth();
  if (!tracked.ok() || !T_world_depth) return false;
  const Se3& T_world_base = window[tracked.base.slot].pose.T_world_camera;
  return depth.is_too_old_for(tracked.motion.T_current_reference * T_world_base.inverse() * *T_world_depth);
}

// The first frame of a world defines it, unless set_pose() or gravity did. After a loss the frame starts at
// the last good pose propagated by the priors, or at that pose itself with the process noise of all the
// unobserved time. If the position may then be anywhere, the frame is the first of another world.
void decide_start(const Window& window, const GravityFilter& gravity, const CurrentFrame& frame,
                  bool start_is_set, Decision& decision) {
  const Config& config = frame.context.config;
  decision.outcome = Decision::Outcome::kStart;
  bool first = !window.has_last();
  if (first) {
    decision.pose = window.current_frame().pose;
  } else if (frame.predicted.sensed.known()) {
    decision.pose = sensed_pose(window, gravity, frame, true).pose;
    decision.gravity = Decision::Gravity::kTaken;
  } else {
    decision.pose = unobserved_pose(window, config.references, frame.stamp_ns());
  }
  if (!first && may_be_anywhere(decision.pose.covariance)) {
    first = decision.new_world = true;
    decision.pose = PoseWithCovariance();
    decision.gravity = Decision::Gravity::kRead;
  }
  if (!first || !config.level_world || (start_is_set && !decision.new_world)) return;
  decision.gravity = Decision::Gravity::kLevel;
  if (frame.prior.gravity) return;
  decision.outcome = Decision::Outcome::kWait;
  decision.status = {StatusCode::kNotFound,
                     "waiting for gravity in the first frame's prior (Config::level_world)"};
}

// Which references stay, by the inliers of the last estimate. A reference with more features than the budget
// allows would keep the cost as high as before.
Window::Kept still_good(const Window& window, const ReferenceTracking& tracking, const Config& config,
                        const FeatureCapacity& capacity, const MotionBase& base) {
  const ReferenceConfig& references = config.references;
  const bool all = base.kind == MotionBase::Kind::kReferences;
  const bool both = all && window.has_recent();
  const auto good = [&](int slot, std::size_t index, double share) {
    const FrameFeatures& features = window[slot].features;
    return features.points.keypoints.size() <= capacity.keypoints &&
           features.lines.segments.size() <= capacity.segments &&
           still_seen(features, tracking.tracks(index), share);
  };
  Window::Kept kept;
  kept.older = all && window.has_older() && good(window.older(), both ? 2 : 1, kOlderInlierRatio);
  kept.keyframe = references.policy != ReferencePolicy::kPreviousFrame &&
                  good(base.slot, 0, references.keyframe_inlier_ratio);
  if (both)
    kept.recent = window.recent_is_young() && good(window.recent(), 1, kRecentInlierRatio);
  else  // Without registration find() is the whole estimate, with the base alone.
    kept.recent = !config.points.registered || references_of(references.policy) == 1;
  kept.recent = kept.recent && kept.keyframe;
  return kept;
}

}  // namespace

[[gnu::noinline]] Decision Odometry::decide(const CurrentFrame& frame, const TrackedMotion& tracked) const {
  Decision decision;
  const FrameFeatures& features = frame.features;
  const bool enough = features.count_3d() >= kMinStartFeatures;
  const char* const first_word = frame.predicted.sensed.known() ? "predicted: " : "lost: ";
  if (depth_.has_stopped() || is_too_old(depth_, window_, tracked)) {
    decision.outcome = Decision::Outcome::kLose;
    decision.depth_has_stopped = true;
    decision.status = depth_.explain_stop(first_word);
  } else if (tracked.ok()) {
    decision.outcome = Decision::Outcome::kTrack;
    if (tracked.base.kind == MotionBase::Kind::kLost)
      decision.status = {
          StatusCode::kOk,
          "tracking restarts from the lost frame before: the covariance includes the unobserved motion"};
    decision.kept = still_good(window_, memory_.tracking, *config_, budget_.capacity(), tracked.base);
  } else if (window_.has_keyframe() && !tracked.gives_up) {
    decision.outcome = Decision::Outcome::kLose;
    decision.status = explain_loss(features, tracked, first_word);
    decision.usable = enough;
  } else if (enough) {
    decide_start(window_, gravity_, frame, start_is_set_, decision);
  } else if (window_.has_last()) {
    decision.outcome = Decision::Outcome::kLose;
    decision.status = hardly_anything(StatusCode::kTooFewFeatures, first_word, features);
  } else {
    decision.outcome = Decision::Outcome::kWait;
    decision.status =
        Status(StatusCode::kTooFewFeatures,
               "waiting for a first frame with texture and depth; 3D points and lines in this one: ")
            .append(features.count_3d());
  }
  return decision;
}

}  // namespace plvo
