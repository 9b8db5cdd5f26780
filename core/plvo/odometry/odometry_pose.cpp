// SPDX-License-Identifier: Apache-2.0
// Poses of the kept frames in the world: they are set, forgotten, and propagated by the priors alone.
#include "plvo/math/symmetric_eigen.hpp"
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/odometry/stamp_error.hpp"

namespace plvo {
namespace {

// The velocity replaces a missing part of a prior for this long; after that the camera is taken to stand
// still.
constexpr std::int64_t kLongestCoast_ns = 300'000'000;

// Farther than any place on Earth, in any system of coordinates; a double still resolves 0.01 µm there.
constexpr double kFarthestPose_m = 1e8;

bool is_semidefinite_covariance(const Matrix6& C) {
  if (!C.allFinite()) return false;
  const double largest = C.cwiseAbs().maxCoeff();
  return largest <= kMostPositionVariance && (C - C.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * largest &&
         symmetric_eigen<6>(C).values.minCoeff() >= -1e-9 * largest;
}

}  // namespace

void Odometry::reset() {
  if (!ready_) return;
  forget_world();
  world_is_lost_ = false;
  points_found_ = {};
  window_.reset();
  view_slot_ = window_.current();
  noise_ = config().noise.initial;
  last_stamp_ns_ = 0;
  has_stamp_ = false;
  point_track_count_ = line_track_count_ = segment_count_ = reference_segment_count_ = 0;
}

Status Odometry::set_pose(const Se3& T_world_camera, const Matrix6& covariance) {
  if (!ready_) return {StatusCode::kInvalidArgument, "set_pose() before a successful init()"};
  if (!T_world_camera.is_finite() || !is_rotation(T_world_camera.R) ||
      !(T_world_camera.t.cwiseAbs().maxCoeff() <= kFarthestPose_m))
    return {StatusCode::kInvalidArgument,
            "set_pose: the pose must be finite, its R a rotation matrix, its position within 1e8 m"};
  if (!is_semidefinite_covariance(covariance))
    return {StatusCode::kInvalidArgument,
            "set_pose: the covariance must be finite, symmetric and without negative eigenvalues"};
  gravity_.forget();
  PoseWithCovariance pose;
  pose.T_world_camera = {renormalise(T_world_camera.R), T_world_camera.t};
  pose.covariance = covariance;
  start_is_set_ = true;
  world_is_lost_ = false;
  window_.kept().clear();  // their poses belong to the old world
  // The keyframe moves with the last frame: the motion between them does not change.
  if (window_.has_last())
    window_.move_last(pose, Matrix6::Zero());
  else
    window_.set_pose(window_.current(), pose);
  return {};
}

// Reports a pose at its stamp, with the error of the stamp.
void Odometry::report(const PoseWithCovariance& pose, const Vector6& velocity, TrackResult& result) const {
  result.T_world_camera = pose.T_world_camera;
  result.pose_covariance =
      pose.covariance + stamp_covariance_of_pose(pose.T_world_camera, velocity, camera().stamp_sigma_s);
}

// Takes in the motion of the prior since the frame before.
void Odometry::sense(const MotionPrior& prior, std::int64_t stamp_ns) {
  if (!window_.has_last()) return;
  const Window::Frame& last = window_.last_frame();
  const bool goes_on = last.motion_ns > 0 && last.motion_ns <= kLongestCoast_ns &&
                       elapsed_ns(last.features.stamp_ns, stamp_ns) <= kLongestCoast_ns;
  const double seconds = static_cast<double>(elapsed_ns(last_stamp_ns_, stamp_ns)) * 1e-9;
  propagated_prior_.extend(prior, goes_on ? last.velocity : Vector6::Zero(), seconds, config().references);
}

// Pose from the priors alone, chained to the keyframe or, without one, to the last good frame. The correction
// by gravity applies to this frame only: the kept frames were observed, this one was not.
PoseWithCovariance Odometry::predicted_pose(const MotionPrior& prior, TrackResult& result) const {
  const int anchor = window_.has_keyframe() ? window_.keyframe() : window_.last();
  const MotionReference last = window_.from_keyframe(window_.last());
  result.T_camera_reference = propagated_prior_.T_current_last() * last.T_reference_base;
  result.motion_covariance =
      compose_covariance(propagated_prior_.T_current_last(), propagated_prior_.covariance(),
                         last.T_reference_base, window_.last_motion().total());
  result.reference_stamp_ns = window_[anchor].features.stamp_ns;
  PoseWithCovariance from = window_[anchor].pose;
  PoseWithCovariance pose = advance(from, result.T_camera_reference, result.motion_covariance);
  GravityFilter gravity = gravity_;
  if (prior.gravity && gravity.known()) gravity.read(*prior.gravity, from, pose);
  report(pose, window_.last_frame().velocity, result);
  result.state = TrackState::kPredicted;
  return pose;
}

}  // namespace plvo
