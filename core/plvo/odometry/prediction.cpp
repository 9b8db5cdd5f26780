// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/prediction.hpp"

#include <algorithm>

#include "plvo/math/covariance.hpp"
#include "plvo/odometry/elapsed.hpp"

namespace plvo {
namespace {

// Motion from the reference to the current frame: from other sensors, or else by constant velocity from the
// last two good frames.
Reference reference_of(const Window& window, int slot, std::int64_t stamp_ns,
                       const PredictedMotion& predicted) {
  const Window::Frame& from = window[slot];
  const Window::Frame& last = window.last_frame();
  const std::int64_t elapsed = elapsed_ns(last.features.stamp_ns, stamp_ns);
  const Se3 T_last_reference = last.pose.T_world_camera.inverse() * from.pose.T_world_camera;
  Reference reference;
  reference.features = &from.features;
  reference.pose = window.from_keyframe(slot);
  reference.T_current_predicted = T_last_reference;
  if (predicted.sensed.known())
    reference.T_current_predicted = predicted.sensed.T_current_last() * T_last_reference;
  else
    reference.T_current_predicted = coasted_motion(last.velocity, elapsed) * T_last_reference;
  PairTiming& timing = reference.timing;
  timing.T_reference_last = from.pose.T_world_camera.inverse() * last.pose.T_world_camera;
  timing.since_last_ns = elapsed;
  timing.reference = from.velocity;
  timing.reference_is_last = slot == window.last();
  timing.last = last.velocity;
  timing.depth_after_colour_s = predicted.depth_after_colour_s;
  return reference;
}

}  // namespace

double depth_after_colour_s(const CameraModel& camera, std::int64_t depth_stamp_ns, std::int64_t stamp_ns) {
  if (!camera.depth_timing.known) return 0;
  // Stamps farther apart than this do not belong to one frame.
  constexpr double kMost_s = 0.1;
  const double apart = static_cast<double>(depth_stamp_ns) - static_cast<double>(stamp_ns);
  return std::clamp(apart * 1e-9, -kMost_s, kMost_s) + camera.depth_timing.delay_s;
}

[[gnu::noinline]] PredictedMotion predict(const Window& window, const CameraModel& camera,
                                          std::int64_t stamp_ns, const PropagatedPrior& sensed,
                                          double depth_after_colour_s,
                                          std::span<Reference, kMaxReferences> references) {
  PredictedMotion predicted;
  predicted.sensed = sensed;
  predicted.depth_after_colour_s = depth_after_colour_s;
  if (!window.has_last()) return predicted;
  predicted.last = window.from_keyframe(window.last());
  const Reference from_last = reference_of(window, window.last(), stamp_ns, predicted);
  predicted.exposure = current_exposure(camera, from_last.timing, from_last.T_current_predicted);
  const Window::References slots = window.references();
  for (std::size_t r = 0; r < slots.count; ++r)
    references[r] = reference_of(window, slots.slots[r], stamp_ns, predicted);
  predicted.references = references.first(slots.count);
  return predicted;
}

[[gnu::noinline]] PredictedMotion predict_from_lost(const Window& window, const CurrentFrame& frame,
                                                    Reference& reference) {
  const StageContext& context = frame.context;
  const Window::Frame& lost = window[window.lost()];
  const std::int64_t elapsed = elapsed_ns(lost.features.stamp_ns, frame.stamp_ns());
  PredictedMotion predicted;
  predicted.depth_after_colour_s = frame.predicted.depth_after_colour_s;
  predicted.sensed.restart();
  predicted.sensed.extend(frame.prior, Vector6::Zero(), static_cast<double>(elapsed) * 1e-9,
                          context.config.references);
  predicted.references = {&reference, 1};
  reference.features = &lost.features;
  if (predicted.sensed.known()) reference.T_current_predicted = predicted.sensed.T_current_last();
  reference.timing.since_last_ns = elapsed;
  reference.timing.depth_after_colour_s = predicted.depth_after_colour_s;
  predicted.exposure = current_exposure(context.camera, reference.timing, reference.T_current_predicted);
  return predicted;
}

[[gnu::noinline]] PoseWithCovariance unobserved_pose(const Window& window, const ReferenceConfig& config,
                                                     std::int64_t stamp_ns) {
  const Window::Frame& last = window.last_frame();
  PoseWithCovariance pose = last.pose;
  const std::int64_t elapsed = elapsed_ns(last.features.stamp_ns, stamp_ns);
  const Se3 T_now_last = coasted_motion(last.velocity, elapsed);
  const Vector6 coasted = boxminus(pose.T_world_camera * T_now_last.inverse(), pose.T_world_camera);
  pose.covariance += coasted.lazyProduct(coasted.transpose());
  add_process_noise(config, static_cast<double>(elapsed) * 1e-9, pose.covariance);
  return pose;
}

[[gnu::noinline]] SensedPose pose_after(const Window& window, const GravityFilter& gravity,
                                        const Se3& T_current_last, const Matrix6& covariance,
                                        const MotionPrior& prior, bool given_up) {
  const bool chained = window.has_keyframe() && !given_up;
  const Se3 T_last_reference = chained ? window.from_keyframe(window.last()).T_reference_base : Se3{};
  SensedPose result;
  result.T_camera_reference = T_current_last * T_last_reference;
  result.motion_covariance =
      compose_covariance(T_current_last, covariance, T_last_reference,
                         chained ? window.last_motion().total() : Matrix6(Matrix6::Zero()));
  PoseWithCovariance from = window.last_frame().pose;
  result.pose = advance(from, T_current_last, covariance);
  if (prior.gravity && gravity.known()) GravityFilter(gravity).read(*prior.gravity, from, result.pose);
  return result;
}

}  // namespace plvo
