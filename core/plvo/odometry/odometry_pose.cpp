// SPDX-License-Identifier: Apache-2.0
// Where the frames that are kept stand in the world: set, forgotten, and gone on from by the priors alone.
#include "plvo/math/symmetric_eigen.hpp"
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/odometry/stamp_error.hpp"

namespace plvo {
namespace {

// What a prior leaves out of the motion goes on as it did for so long, then stands still.
constexpr std::int64_t kLongestCoast_ns = 300'000'000;

// Beyond any place on Earth, in any system of coordinates; a double still tells 0.01 µm there.
constexpr double kFarthestPose_m = 1e8;

bool is_semidefinite_covariance(const Matrix6& C) {
  if (!C.allFinite()) return false;
  const double largest = C.cwiseAbs().maxCoeff();
  return largest <= 1e6 && (C - C.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * largest &&
         symmetric_eigen<6>(C).values.minCoeff() >= -1e-9 * largest;
}

}  // namespace

void Odometry::reset() {
  if (!ready_) return;
  forget_world();
  world_is_lost_ = false;
  points_found_ = {};
  current_ = view_slot_ = 0;
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
  kept_.clear();  // their poses are in the world that was
  if (last_ == kInvalidSlot) {
    hold(current_, pose);
    return {};
  }
  // The keyframe moves with the last frame: the motion between them stays what it is.
  if (keyframe_ != kInvalidSlot)
    move_keyframe(keyframe_ == last_
                      ? pose
                      : advance(pose, from_keyframe(last_).T_reference_base.inverse(), Matrix6::Zero()));
  hold(last_, pose);
  return {};
}

PoseWithCovariance Odometry::held(int slot) const {
  return {frame(slot).T_world_camera, frame(slot).covariance, frame(slot).covariance_with_gravity};
}

// What is not finite is found where the result leaves.
void Odometry::hold(int slot, PoseWithCovariance pose) {
  (void)settle(pose);
  frame(slot).T_world_camera = pose.T_world_camera;
  frame(slot).covariance = pose.covariance;
  frame(slot).covariance_with_gravity = pose.covariance_with_gravity;
}

// What the caller is told of a pose: of its stamp, which may err.
void Odometry::report(const PoseWithCovariance& pose, const Vector6& velocity, TrackResult& result) const {
  result.T_world_camera = pose.T_world_camera;
  result.pose_covariance =
      pose.covariance + stamp_covariance_of_pose(pose.T_world_camera, velocity, camera().stamp_sigma_s);
}

// A frame as a reference whose pose relative to the keyframe is known.
MotionReference Odometry::from_keyframe(int slot) const {
  if (keyframe_ == kInvalidSlot || keyframe_ == slot) return {};
  const Matrix6& covariance = slot == older_    ? older_covariance_
                              : slot == recent_ ? recent_motion_.covariance
                                                : last_motion_.covariance;
  return {frame(slot).T_world_camera.inverse() * frame(keyframe_).T_world_camera, covariance};
}

// The keyframe is put right; the frames that are matched beside it go on standing where they do from there.
void Odometry::move_keyframe(const PoseWithCovariance& pose) {
  for (const int slot : {last_, older_, recent_ == last_ ? kInvalidSlot : recent_})
    if (slot != kInvalidSlot && slot != keyframe_)
      frame(slot).T_world_camera = pose.T_world_camera * from_keyframe(slot).T_reference_base.inverse();
  hold(keyframe_, pose);
}

// Takes in what the prior says of the motion since the frame before.
void Odometry::sense(const MotionPrior& prior, std::int64_t stamp_ns) {
  if (last_ == kInvalidSlot) return;
  const Frame& last = frame(last_);
  const bool goes_on = last.motion_ns > 0 && last.motion_ns <= kLongestCoast_ns &&
                       elapsed_ns(last.features.stamp_ns, stamp_ns) <= kLongestCoast_ns;
  const double seconds = static_cast<double>(elapsed_ns(last_stamp_ns_, stamp_ns)) * 1e-9;
  propagated_prior_.extend(prior, goes_on ? last.velocity : Vector6::Zero(), seconds, config().references);
}

// Where the priors alone lead, chained to the keyframe or, where there is none, to the last good frame. What
// gravity corrects in it is this frame's alone: the frames that are kept have been seen, it has not.
PoseWithCovariance Odometry::predicted_pose(const MotionPrior& prior, TrackResult& result) const {
  const int anchor = keyframe_ != kInvalidSlot ? keyframe_ : last_;
  const MotionReference last = from_keyframe(last_);
  result.T_camera_reference = propagated_prior_.T_current_last() * last.T_reference_base;
  result.motion_covariance =
      compose_covariance(propagated_prior_.T_current_last(), propagated_prior_.covariance(),
                         last.T_reference_base, last_motion_.total());
  result.reference_stamp_ns = frame(anchor).features.stamp_ns;
  PoseWithCovariance from = held(anchor);
  PoseWithCovariance pose = advance(from, result.T_camera_reference, result.motion_covariance);
  GravityFilter gravity = gravity_;
  if (prior.gravity && gravity.known()) gravity.read(*prior.gravity, from, pose);
  report(pose, frame(last_).velocity, result);
  result.state = TrackState::kPredicted;
  return pose;
}

}  // namespace plvo
