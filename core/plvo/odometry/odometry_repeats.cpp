// SPDX-License-Identifier: Apache-2.0
// Part of the odometry: images that the sensor delivers again (image_repeats.hpp). A repeated colour image
// shows no motion; the frame is passed over, and its pose is predicted. A depth image that is repeated for a
// short time comes from a slower depth camera and is used. If it stays for longer while the camera moves, the
// depth stream has stopped, and the frames are lost until a new depth image comes.
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo {
namespace {

// A depth camera in its slowest usual mode delivers six images a second.
constexpr std::int64_t kOldestDepth_ns = 200'000'000;
// A camera that stands still may see the same depth for ever, if the depth has no noise (a simulator). The
// depth is called stopped when the camera has moved by this much since the image came (m and rad).
constexpr double kMovedSinceDepth = 0.01;

}  // namespace

// Whether the frame has the colour image of the last frame with a pose. After a lost frame, the motion is
// searched even if the image is repeated: there is no pose from which to predict.
bool Odometry::is_passed_over() const {
  return window_.has_last() && !is_lost_ && repeats_.colour_is_repeated();
}

// Predicts the pose at the stamp of a repeated frame, by the priors or by the last velocity. Nothing that the
// next frame needs is changed.
[[gnu::noinline]] TrackResult Odometry::pass_over(const RgbdFrame& input, const MotionPrior& prior) {
  propagated_prior_ = predict(input, prior).sensed;
  last_stamp_ns_ = input.stamp_ns;
  Se3 T_current_last = propagated_prior_.T_current_last();
  Matrix6 covariance = propagated_prior_.covariance();
  const Window::Frame& last = window_.last_frame();
  if (!propagated_prior_.known()) {
    const std::int64_t elapsed = elapsed_ns(last.features.stamp_ns, input.stamp_ns);
    T_current_last = coasted_motion(input.stamp_ns);
    covariance.setZero();
    add_process_noise(config_->references, static_cast<double>(elapsed) * 1e-9, covariance);
  }
  const SensedPose predicted = pose_after(T_current_last, covariance, prior);
  TrackResult result;
  result.state = TrackState::kTracking;
  result.status = {StatusCode::kOk, "the colour image is that of the frame before: the pose is predicted"};
  result.repeated = true;
  result.stamp_ns = input.stamp_ns;
  result.reference_stamp_ns = window_[window_.base()].features.stamp_ns;
  result.T_camera_reference = predicted.T_camera_reference;
  result.motion_covariance = predicted.motion_covariance;
  result.feature_step = budget_.step();
  report(predicted.pose, last.velocity.value, result);
  return result;
}

// Remembers where the camera was when the depth image of this frame came. Called for a frame with a pose.
[[gnu::noinline]] void Odometry::note_depth() {
  if (has_depth_pose_ && repeats_.depth_is_repeated()) return;
  T_world_depth_ = window_.last_frame().pose.T_world_camera;
  has_depth_pose_ = true;
}

// Whether the depth image is an old one, and the camera has moved since it came.
[[gnu::noinline]] bool Odometry::depth_has_stopped(const TrackedMotion& tracked) const {
  if (!tracked.ok() || !has_depth_pose_ || repeats_.depth_age_ns() <= kOldestDepth_ns) return false;
  const Se3& T_world_keyframe = window_[window_.keyframe()].pose.T_world_camera;
  const Se3 T_current_depth =
      tracked.motion.T_current_reference * T_world_keyframe.inverse() * T_world_depth_;
  return boxminus(T_current_depth, Se3{}).norm() > kMovedSinceDepth;
}

Status Odometry::stopped_depth(const char* first_word) const {
  return Status(StatusCode::kDamaged, first_word)
      .append("the depth image has been the same for ")
      .append(static_cast<std::ptrdiff_t>(repeats_.depth_age_ns() / 1'000'000))
      .append(" ms while the colour image moves: the depth stream has stopped; restart the camera");
}

}  // namespace plvo
