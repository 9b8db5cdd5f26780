// SPDX-License-Identifier: Apache-2.0
// The outcome of a frame: it starts a world, starts anew after a loss, has a motion, or has none. Also
// selects the frames that the next ones are matched with.
#include <algorithm>

#include "plvo/math/covariance.hpp"
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/odometry/stamp_error.hpp"

namespace plvo {
namespace {

// A frame with fewer 3D points and lines than this cannot start a trajectory.
constexpr int kMinStartFeatures = 20;
// A recent frame is matched while at least this share of its features are inliers.
constexpr double kRecentInlierRatio = 0.5;

int features_3d(const TrackResult& result) { return result.points.with_depth + result.lines.with_depth; }
bool too_few_features(const TrackResult& result) { return features_3d(result) < kMinStartFeatures; }

Status hardly_anything(StatusCode code, const char* first_word, const TrackResult& result) {
  return Status(code, first_word)
      .append("hardly anything to see (dark, blurred, bare, or no depth); keypoints: ")
      .append(result.points.detected)
      .append(", 3D points and lines: ")
      .append(features_3d(result));
}

// States why no motion was found, and what would help.
Status explain_loss(const MotionEstimate& motion, const TrackResult& result, const char* first_word) {
  if (too_few_features(result)) return hardly_anything(motion.status, first_word, result);
  Status status(motion.status, first_word);
  switch (motion.status) {
    case StatusCode::kTooFewFeatures:
      return status.append("too few features of the reference were found again: ")
          .append(result.points.matched + result.lines.matched);
    case StatusCode::kNoConsensus:
      return status.append("the matches do not agree on one motion; matches: ")
          .append(result.points.matched + result.lines.matched);
    case StatusCode::kDegenerate:
      return status.append("what is seen leaves some direction of motion open; inliers: ")
          .append(result.points.inliers + result.lines.inliers);
    default:
      return status.append("the motion did not converge; inliers: ")
          .append(result.points.inliers + result.lines.inliers);
  }
}

}  // namespace

// Handles the very first usable frame: it defines the world, unless set_pose() or gravity did.
void Odometry::start_first(const MotionPrior& prior, TrackResult& result) {
  result.state = TrackState::kInitialising;
  if (too_few_features(result)) {
    result.status =
        Status(StatusCode::kTooFewFeatures,
               "waiting for a first frame with texture and depth; 3D points and lines in this one: ")
            .append(features_3d(result));
    return;
  }
  const bool levels = config().level_world && !start_is_set_;
  if (levels && !prior.gravity) {
    result.status = {
        StatusCode::kNotFound,
        "waiting for gravity: Config::level_world wants the first frame's prior to say where down is"};
    return;
  }
  PoseWithCovariance pose = window_.current_frame().pose;
  if (levels)
    gravity_.level(*prior.gravity, pose);
  else
    read_gravity(prior, pose);
  start_at(pose, result);
  if (!world_is_lost_) return;
  world_is_lost_ = false;
  result.status = {StatusCode::kOk,
                   "a new world starts: where the camera is in the one before is not known any more"};
}

// Starts anew after a loss, when the references were given up. The new pose is the last good pose propagated
// by the priors, or that pose itself with the process noise of all the unobserved time. If the position may
// then be anywhere, the frame is the first of another world.
void Odometry::start_again(const MotionPrior& prior, TrackResult& result) {
  if (too_few_features(result)) {
    result.state = TrackState::kLost;
    result.status = hardly_anything(StatusCode::kTooFewFeatures, first_word_of_loss(), result);
    if (propagated_prior_.known()) (void)predicted_pose(prior, result);
    return;
  }
  const bool sensed = propagated_prior_.known();
  PoseWithCovariance pose = sensed ? predicted_pose(prior, result) : window_.last_frame().pose;
  if (!sensed) add_process_noise(result.stamp_ns, pose.covariance);
  if (may_be_anywhere(pose.covariance)) {
    forget_world();
    report(PoseWithCovariance(), Vector6::Zero(), result);
    result.T_camera_reference = Se3();
    result.motion_covariance.setZero();
    start_first(prior, result);
    return;
  }
  if (!sensed) read_gravity(prior, pose);
  start_at(pose, result);
}

// Forgets all poses and what depends on them; the learnt noise stays. The next usable frame is the first of a
// new world.
void Odometry::forget_world() {
  window_.clear();
  frames_since_relocalisation_ = 0;
  start_is_set_ = false;
  propagated_prior_ = PropagatedPrior();
  gravity_.forget();
  lost_frames_ = 0;
  world_is_lost_ = true;
}

// Takes in gravity for a camera that is not chained to an earlier pose.
void Odometry::read_gravity(const MotionPrior& prior, PoseWithCovariance& pose) {
  PoseWithCovariance itself = pose;
  if (prior.gravity) gravity_.read(*prior.gravity, itself, pose);
}

// Makes the current frame the keyframe and the last good one, without a motion before it.
void Odometry::start_at(const PoseWithCovariance& pose, TrackResult& result) {
  describe_points(result);
  keep_image();
  window_.start(pose);
  report(window_.last_frame().pose, Vector6::Zero(), result);
  result.T_camera_reference = Se3();
  result.motion_covariance.setZero();
  result.state = TrackState::kInitialising;
  result.reference_stamp_ns = result.stamp_ns;
  lost_frames_ = 0;
  propagated_prior_.restart();
}

// Adds the process noise of the unobserved motion since the last good frame to the covariance of its pose.
void Odometry::add_process_noise(std::int64_t stamp_ns, Matrix6& covariance) const {
  const double seconds =
      static_cast<double>(elapsed_ns(window_.last_frame().features.stamp_ns, stamp_ns)) * 1e-9;
  const double sigma_m = config().references.process_noise_m_per_s * seconds;
  const double sigma_rad = config().references.process_noise_rad_per_s * seconds;
  for (int i = 0; i < 3; ++i) {
    covariance(i, i) += sigma_m * sigma_m;
    double& turned = covariance(3 + i, 3 + i);
    turned += std::clamp(kMostRotationVariance - turned, 0.0, sigma_rad * sigma_rad);
  }
}

void Odometry::accept(const DepthSampler& depth, const TrackedMotion& tracked, const MotionPrior& prior,
                      TrackResult& result) {
  const MotionEstimate& motion = tracked.motion;
  const Window::Kept kept = still_good();
  if (!kept.recent) {
    find_points(depth, result);
    if (!kept.keyframe) describe_points(result);
    memory_.extraction.lift(depth.with(tracked.exposure), noise_, arena_, window_.current_frame().features);
  }
  result.state = TrackState::kTracking;
  result.T_camera_reference = motion.T_current_reference;
  const Matrix6 common_mode = common_mode_error(motion.references, window_.recent_motion().common_mode,
                                                config().noise.common_mode_share);
  window_.set_motion({motion.C_H, common_mode});
  const Matrix6 covariance = window_.last_motion().total();
  PoseWithCovariance from = window_[window_.keyframe()].pose;
  PoseWithCovariance pose = advance(from, motion.T_current_reference, covariance);
  if (prior.gravity) {
    gravity_.read(*prior.gravity, from, pose);
    window_.move_keyframe(from);
  }
  window_.set_pose(window_.current(), pose);
  window_.set_velocity(elapsed_ns(window_.last_frame().features.stamp_ns, result.stamp_ns));
  const Vector6& velocity = window_.current_frame().velocity;
  report(window_.current_frame().pose, velocity, result);
  result.motion_covariance =
      covariance + stamp_covariance_of_motion(motion.T_current_reference, velocity,
                                              window_[window_.keyframe()].velocity, camera().stamp_sigma_s);
  lost_frames_ = 0;
  propagated_prior_.restart();
  learn(config().noise, tracked.observed, noise_);
  const bool keep_older =
      config().references.policy == ReferencePolicy::kWindow && config().points.registered;
  if (!kept.recent) keep_image();
  window_.advance(kept, keep_older);
}

// Judges the references by the inliers of the last estimate.
Window::Kept Odometry::still_good() const {
  const ReferenceConfig& references = config().references;
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
    kept.recent = !config().points.registered || references_of(references.policy) == 1;
  kept.recent = kept.recent && kept.keyframe;
  return kept;
}

// Keeps the image of the current frame, which is the latest reference from now on.
void Odometry::keep_image() {
  memory_.tracking.keep_image(memory_.extraction.pyramid(), window_.current_frame().features.stamp_ns);
}

// Whether the last estimate found this share of the frame's features; the frame was its reference of this
// index.
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

void Odometry::lose(const MotionEstimate& motion, const MotionPrior& prior, TrackResult& result) {
  result.state = TrackState::kLost;
  result.status = explain_loss(motion, result, first_word_of_loss());
  if (propagated_prior_.known()) (void)predicted_pose(prior, result);
  ++lost_frames_;
  if (lost_frames_ < config().references.max_lost_frames) return;
  // The views of the references are out of sight. Unless one comes back, the next usable frame starts anew at
  // the last good pose.
  window_.give_up();
}

const char* Odometry::first_word_of_loss() const {
  return propagated_prior_.known() ? "predicted: " : "lost: ";
}

}  // namespace plvo
