// SPDX-License-Identifier: Apache-2.0
// Part of the odometry: what the outcome of a frame is, and why.
#include "plvo/math/covariance.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo {
namespace {

// A frame with fewer 3D points and lines than this cannot start a trajectory.
constexpr int kMinStartFeatures = 20;
// A recent frame is matched while at least this share of its features are inliers.
constexpr double kRecentInlierRatio = 0.5;

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
      return status.append("what is seen leaves some direction of motion open; inliers: ")
          .append(tracked.inliers());
    default: return status.append("the motion did not converge; inliers: ").append(tracked.inliers());
  }
}

}  // namespace

[[gnu::noinline]] Odometry::Decision Odometry::decide(const CurrentFrame& frame, const TrackedMotion& tracked,
                                                      const MotionPrior& prior) const {
  Decision decision;
  const char* const first_word = frame.predicted.sensed.known() ? "predicted: " : "lost: ";
  if (depth_has_stopped_) {
    decision.outcome = Decision::Outcome::kLose;
    decision.status = stopped_depth(first_word);
  } else if (tracked.ok()) {
    decision.outcome = Decision::Outcome::kTrack;
    if (tracked.restarted)
      decision.status = {StatusCode::kOk,
                         "tracking restarts from the lost frame before: the motion up to that frame was not "
                         "observed, and the covariance includes it"};
    decision.kept = still_good();
  } else if (window_.has_keyframe()) {
    decision.outcome = Decision::Outcome::kLose;
    decision.status = explain_loss(frame.features, tracked, first_word);
    decision.usable = frame.features.count_3d() >= kMinStartFeatures;
  } else if (frame.features.count_3d() >= kMinStartFeatures) {
    decide_start(frame, prior, decision);
  } else if (window_.has_last()) {
    decision.outcome = Decision::Outcome::kLose;
    decision.status = hardly_anything(StatusCode::kTooFewFeatures, first_word, frame.features);
  } else {
    decision.outcome = Decision::Outcome::kWait;
    decision.status =
        Status(StatusCode::kTooFewFeatures,
               "waiting for a first frame with texture and depth; 3D points and lines in this one: ")
            .append(frame.features.count_3d());
  }
  return decision;
}

// The first frame of a world defines it, unless set_pose() or gravity did. After a loss the frame starts at
// the last good pose propagated by the priors, or at that pose itself with the process noise of all the
// unobserved time. If the position may then be anywhere, the frame is the first of another world.
void Odometry::decide_start(const CurrentFrame& frame, const MotionPrior& prior, Decision& decision) const {
  decision.outcome = Decision::Outcome::kStart;
  bool first = !window_.has_last();
  if (first) {
    decision.pose = window_.current_frame().pose;
  } else if (frame.predicted.sensed.known()) {
    decision.pose = sensed_pose(frame, prior).pose;
    decision.gravity = Decision::Gravity::kTaken;
  } else {
    decision.pose = unobserved_pose(frame.stamp_ns());
  }
  if (!first && may_be_anywhere(decision.pose.covariance)) {
    first = decision.new_world = true;
    decision.pose = PoseWithCovariance();
    decision.gravity = Decision::Gravity::kRead;
  }
  if (!first || !config_->level_world || (start_is_set_ && !decision.new_world)) return;
  decision.gravity = Decision::Gravity::kLevel;
  if (prior.gravity) return;
  decision.outcome = Decision::Outcome::kWait;
  decision.status = {
      StatusCode::kNotFound,
      "waiting for gravity: Config::level_world wants the first frame's prior to say where down is"};
}

// Judges the references by the inliers of the last estimate.
Window::Kept Odometry::still_good() const {
  const ReferenceConfig& references = config_->references;
  const bool window = references.policy == ReferencePolicy::kWindow;
  const bool both = window_.has_recent();
  const auto good = [&](int slot, std::size_t index, double share) {
    return affordable(slot) && still_seen(slot, index, share);
  };
  Window::Kept kept;
  kept.older = window_.has_older() && good(window_.older(), both ? 2 : 1, references.older_inlier_ratio);
  kept.keyframe =
      references.policy != ReferencePolicy::kPreviousFrame &&
      good(window_.keyframe(), 0, window ? references.window_inlier_ratio : references.keyframe_inlier_ratio);
  if (both)
    kept.recent = recent_is_young() && good(window_.recent(), 1, kRecentInlierRatio);
  else  // Without registration find() is the whole estimate, with the base alone.
    kept.recent = !config_->points.registered || references_of(references.policy) == 1;
  kept.recent = kept.recent && kept.keyframe;
  return kept;
}

// Whether this share of the features of the frame in `slot` were inliers of the last estimate. The frame was
// the reference of this index.
bool Odometry::still_seen(int slot, std::size_t reference, double share) const {
  const FrameFeatures& features = window_[slot].features;
  std::size_t available = features.lines.count_3d;
  for (const Point3d& point : features.points.points.first(features.points.keypoints.size()))
    available += point.p.z() > 0 ? 1 : 0;
  return memory_.tracking.tracks(reference).inliers >= share * static_cast<double>(available);
}

// A frame with more features than the budget allows would keep the cost as high as before.
bool Odometry::affordable(int slot) const {
  const FrameFeatures& features = window_[slot].features;
  const FeatureCapacity capacity = budget_.capacity();
  return features.points.keypoints.size() <= capacity.keypoints &&
         features.lines.segments.size() <= capacity.segments;
}

}  // namespace plvo
