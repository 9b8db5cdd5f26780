// SPDX-License-Identifier: Apache-2.0
// Part of the odometry: the prediction of a frame's motion before its features are associated, and the pose
// of a frame without an observed motion.
#include <algorithm>

#include "plvo/math/covariance.hpp"
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo {

// The references are the keyframe, which is the base, a recent frame, and the previous keyframe, as far as
// the window holds them.
[[gnu::noinline]] PredictedMotion Odometry::predict(const RgbdFrame& input, const MotionPrior& prior) const {
  PredictedMotion predicted;
  predicted.depth_after_colour_s = depth_after_colour_s(input.stamp_ns);
  if (!window_.has_last()) return predicted;
  const Window::Frame& last = window_.last_frame();
  const std::int64_t elapsed = elapsed_ns(last.features.stamp_ns, input.stamp_ns);
  const double seconds = static_cast<double>(elapsed_ns(last_stamp_ns_, input.stamp_ns)) * 1e-9;
  predicted.sensed = propagated_prior_;
  predicted.sensed.extend(prior, last.velocity.continues(elapsed) ? last.velocity.value : Vector6::Zero(),
                          seconds, config_->references);
  predicted.last = window_.from_keyframe(window_.last());
  const Reference from_last = reference_of(window_.last(), input.stamp_ns, predicted);
  predicted.exposure = current_exposure(camera_, from_last.prior, from_last.T_current_predicted);
  if (!window_.has_keyframe()) return predicted;
  const auto add = [&](int slot) {
    predicted.all_references[predicted.reference_count++] = reference_of(slot, input.stamp_ns, predicted);
  };
  add(window_.keyframe());
  if (window_.has_recent()) add(window_.recent());
  if (window_.has_older()) add(window_.older());
  return predicted;
}

// For a repeated depth image, the stamp of its first delivery counts.
double Odometry::depth_after_colour_s(std::int64_t stamp_ns) const {
  if (!camera_.depth_timing.known) return 0;
  // Stamps farther apart than this do not belong to one frame.
  constexpr double kMost_s = 0.1;
  const double apart = static_cast<double>(repeats_.depth_stamp_ns()) - static_cast<double>(stamp_ns);
  return std::clamp(apart * 1e-9, -kMost_s, kMost_s) + camera_.depth_timing.delay_s;
}

// Motion from the reference to the current frame: from other sensors, or else by constant velocity from the
// last two good frames.
Reference Odometry::reference_of(int slot, std::int64_t stamp_ns, const PredictedMotion& predicted) const {
  const Window::Frame& from = window_[slot];
  const Window::Frame& last = window_.last_frame();
  const std::int64_t elapsed = elapsed_ns(last.features.stamp_ns, stamp_ns);
  const double seconds = static_cast<double>(elapsed) * 1e-9;
  const Se3 T_last_reference = last.pose.T_world_camera.inverse() * from.pose.T_world_camera;
  Reference reference;
  reference.features = &from.features;
  reference.pose = window_.from_keyframe(slot);
  reference.T_current_predicted = T_last_reference;
  if (predicted.sensed.known())
    reference.T_current_predicted = predicted.sensed.T_current_last() * T_last_reference;
  else if (last.velocity.predicts(elapsed))
    reference.T_current_predicted = motion_at(last.velocity.value, seconds) * T_last_reference;
  PairPrior& prior = reference.prior;
  prior.T_reference_last = from.pose.T_world_camera.inverse() * last.pose.T_world_camera;
  prior.since_last_ns = elapsed;
  prior.reference = from.velocity;
  prior.reference_is_last = slot == window_.last();
  prior.last = last.velocity;
  prior.depth_after_colour_s = predicted.depth_after_colour_s;
  return reference;
}

// The motion since the last good frame of a camera that kept its velocity for as long as the interval over
// which that was measured, and then stood still.
Se3 Odometry::coasted_motion(std::int64_t stamp_ns) const {
  const Window::Frame& last = window_.last_frame();
  if (!last.velocity.continues(0)) return {};
  const std::int64_t coasted_ns =
      std::min(last.velocity.measured_ns, elapsed_ns(last.features.stamp_ns, stamp_ns));
  return motion_at(window_.smooth_velocity(), static_cast<double>(coasted_ns) * 1e-9);
}

// The last good pose, with the uncertainty of the unobserved motion since then: the process noise, and as one
// standard deviation the motion of a camera that kept its velocity. Tracking is mostly lost in fast motion.
[[gnu::noinline]] PoseWithCovariance Odometry::unobserved_pose(std::int64_t stamp_ns) const {
  const Window::Frame& last = window_.last_frame();
  PoseWithCovariance pose = last.pose;
  const Vector6 coasted =
      boxminus(pose.T_world_camera * coasted_motion(stamp_ns).inverse(), pose.T_world_camera);
  pose.covariance += coasted.lazyProduct(coasted.transpose());
  add_process_noise(config_->references,
                    static_cast<double>(elapsed_ns(last.features.stamp_ns, stamp_ns)) * 1e-9,
                    pose.covariance);
  return pose;
}

// The pose by the priors alone.
Odometry::SensedPose Odometry::sensed_pose(const CurrentFrame& frame, const MotionPrior& prior) const {
  const PropagatedPrior& sensed = frame.predicted.sensed;
  return pose_after(sensed.T_current_last(), sensed.covariance(), prior);
}

// Chained to the keyframe or, without one, to the last good frame. The correction by gravity applies to this
// frame only: the kept frames were observed, this one was not.
[[gnu::noinline]] Odometry::SensedPose Odometry::pose_after(const Se3& T_current_last,
                                                            const Matrix6& covariance,
                                                            const MotionPrior& prior) const {
  const MotionReference last = window_.from_keyframe(window_.last());
  SensedPose result;
  result.T_camera_reference = T_current_last * last.T_reference_base;
  result.motion_covariance =
      compose_covariance(T_current_last, covariance, last.T_reference_base, window_.last_motion().total());
  PoseWithCovariance from = window_[window_.base()].pose;
  result.pose = advance(from, result.T_camera_reference, result.motion_covariance);
  GravityFilter gravity = gravity_;
  if (prior.gravity && gravity.known()) gravity.read(*prior.gravity, from, result.pose);
  return result;
}

}  // namespace plvo
