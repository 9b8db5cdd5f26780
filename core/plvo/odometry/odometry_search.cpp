// SPDX-License-Identifier: Apache-2.0
// Part of the odometry: where the motion of a frame is searched from. The references come first. Where they
// fail, the frame is matched with the lost frame before. If the two agree, tracking restarts from that lost
// frame, whose pose is the last good one with the unobserved motion in the covariance. The old keyframe is
// kept (kept_keyframes.hpp). When its view comes back, the camera is relocalised (recovery.hpp). After some
// time the references are given up.
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/odometry/tracking/motion_search.hpp"

namespace plvo {
namespace {

// Whether the last good frame is so long ago that its pose and velocity do not say where the camera is now.
bool is_unobserved(const Window& window, const CurrentFrame& frame) {
  const Window::Frame& last = window.last_frame();
  const std::int64_t since_last_ns = elapsed_ns(last.features.stamp_ns, frame.stamp_ns());
  return last.velocity.is_out_of_date(since_last_ns) && !frame.predicted.sensed.known() &&
         1e-9 * static_cast<double>(since_last_ns) >= frame.context.config.references.max_lost_s;
}

// Searches for the motion since the lost frame. Not inlined: its prediction is on the stack during this
// search only.
[[gnu::noinline]] void search_from_lost(const Window& window, const CurrentFrame& frame,
                                        ReferenceTracking& tracking, TrackedMotion& tracked) {
  Reference lost;
  const PredictedMotion predicted = predict_from_lost(window, frame, lost);
  search_motion({frame.context, frame.extraction, frame.depth, predicted, frame.features, frame.prior},
                tracking, tracked);
  if (tracked.ok()) tracked.base = {MotionBase::Kind::kLost, window.lost()};
}

// No reference is in view. If the view of the latest kept keyframe is back, the motion is that since this
// keyframe. Otherwise there is no motion, and the lines are lifted without one.
[[gnu::noinline]] void search_from_kept(const Window& window, const CurrentFrame& frame,
                                        ReferenceTracking& tracking, TrackedMotion& tracked) {
  // The camera is taken to stand still: its velocity before the loss is out of date.
  if (const int slot = window.latest_kept();
      slot != Window::kNoFrame &&
      recognise(window[slot], frame, Vector6::Zero(),
                unobserved_pose(window, frame.context.config.references, frame.stamp_ns()), tracking,
                tracked)) {
    tracked.base = {MotionBase::Kind::kKept, slot};
    return;
  }
  tracked.motion.status = StatusCode::kNoConsensus;
  tracked.points = tracked.lines = {};
  frame.extraction.lift_lines(frame.context, frame.depth, frame.predicted.exposure, frame.features.lines);
}

}  // namespace

void Odometry::search(const CurrentFrame& frame, TrackedMotion& tracked) {
  ReferenceTracking& tracking = memory_.tracking;
  if (window_.has_keyframe()) {
    tracked.base.slot = window_.keyframe();
    search_motion(frame, tracking, tracked);
    // After such a gap the view must be recognised, like that of a kept keyframe.
    if (tracked.ok() && is_unobserved(window_, frame) &&
        !still_seen(window_[window_.keyframe()].features, tracking.tracks(0),
                    config_->references.keyframe_inlier_ratio))
      tracked.motion.status = StatusCode::kNoConsensus;
    // Two equal images would agree on no motion, which is not measured.
    if (!tracked.ok() && window_.has_lost() && !colour_.is_repeated())
      search_from_lost(window_, frame, tracking, tracked);
    if (tracked.ok() || !lost_since_ns_) return;
    const double lost_s = static_cast<double>(elapsed_ns(*lost_since_ns_, frame.stamp_ns())) * 1e-9;
    if (lost_s < config_->references.max_lost_s) return;
    tracked.gives_up = true;
  }
  search_from_kept(window_, frame, tracking, tracked);
}

}  // namespace plvo
