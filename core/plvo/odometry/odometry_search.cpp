// SPDX-License-Identifier: Apache-2.0
// Part of the odometry: frames after a loss. The motion of each is searched from the references first. Where
// that fails, the frame is matched with the lost frame before. If the two agree, tracking restarts from that
// lost frame, whose pose is the last good one with the unobserved motion in the covariance. The old keyframe
// is kept (kept_keyframes.hpp). When its view comes back, the camera is relocalised (recovery.cpp). After
// some time the references are given up.
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/odometry/tracking/motion_search.hpp"

namespace plvo {

// Called where the search from the references failed.
[[gnu::noinline]] void Odometry::search_after_loss(const RgbdFrame& input, const MotionPrior& prior,
                                                   const CurrentFrame& frame, PredictedMotion& predicted,
                                                   TrackedMotion& tracked) {
  if (!window_.has_keyframe() || search_from_lost(input, prior, frame, predicted, tracked)) return;
  if (!lost_too_long(input.stamp_ns)) return;
  // The references are out of view. Unless a kept keyframe is recognised, tracking starts anew from this
  // frame.
  window_.give_up();
  resume(frame, tracked);
}

// The motion since the lost frame, which is the frame before. Not inlined, as predict_anew: the temporary
// would otherwise stay on the stack during the search.
[[gnu::noinline]] void Odometry::predict_from_lost(const RgbdFrame& input, const MotionPrior& prior,
                                                   PredictedMotion& predicted) const {
  const Window::Frame& lost = window_[window_.lost()];
  const std::int64_t elapsed = elapsed_ns(lost.features.stamp_ns, input.stamp_ns);
  predicted = PredictedMotion();
  predicted.depth_after_colour_s = depth_after_colour_s(input.stamp_ns);
  predicted.sensed.restart();
  predicted.sensed.extend(prior, Vector6::Zero(), static_cast<double>(elapsed) * 1e-9, config_->references);
  Reference& reference = predicted.all_references[0];
  predicted.reference_count = 1;
  reference.features = &lost.features;
  if (predicted.sensed.known()) reference.T_current_predicted = predicted.sensed.T_current_last();
  reference.prior.since_last_ns = elapsed;
  reference.prior.depth_after_colour_s = predicted.depth_after_colour_s;
  predicted.exposure = current_exposure(camera_, reference.prior, reference.T_current_predicted);
}

[[gnu::noinline]] void Odometry::predict_anew(const RgbdFrame& input, const MotionPrior& prior,
                                              PredictedMotion& predicted) const {
  predicted = predict(input, prior);
}

// Searches for the motion since the lost frame. If it is found, that frame is the keyframe from now on.
bool Odometry::search_from_lost(const RgbdFrame& input, const MotionPrior& prior, const CurrentFrame& frame,
                                PredictedMotion& predicted, TrackedMotion& tracked) {
  // Two equal images would agree on no motion, which is not measured.
  if (!window_.has_lost() || repeats_.colour_is_repeated()) return false;
  predict_from_lost(input, prior, predicted);
  search_motion(frame, memory_.tracking, tracked);
  tracked.restarted = tracked.ok();
  if (tracked.ok())
    window_.go_on_from_lost();
  else
    predict_anew(input, prior, predicted);
  return tracked.ok();
}

bool Odometry::lost_too_long(std::int64_t stamp_ns) const {
  return is_lost_ &&
         static_cast<double>(elapsed_ns(lost_since_ns_, stamp_ns)) * 1e-9 >= config_->references.max_lost_s;
}

// Called for each lost frame. A usable one is kept for the next frame. Its pose is the last good one with the
// covariance of the unobserved motion since then, or the pose by the priors.
void Odometry::note_loss(const CurrentFrame& frame, const Decision& decision, const MotionPrior& prior) {
  if (!is_lost_) lost_since_ns_ = frame.stamp_ns();
  is_lost_ = true;
  window_.drop_lost();
  if (!decision.usable || !window_.can_keep_lost()) return;
  const Exposure& exposure = frame.predicted.exposure;
  const FeatureExtraction& extraction = memory_.extraction;
  frame.find_points();
  frame.describe_points();
  extraction.lift(frame.context, frame.depth.with(exposure), frame.features);
  extraction.lift_lines(frame.context, frame.depth, exposure, frame.features.lines);
  window_.keep_lost(frame.predicted.sensed.known() ? sensed_pose(frame, prior).pose
                                                   : unobserved_pose(frame.stamp_ns()));
}

}  // namespace plvo
