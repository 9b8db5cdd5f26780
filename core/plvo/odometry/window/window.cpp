// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/window/window.hpp"

#include <utility>

namespace plvo {

void Window::init(const Features& features, int kept_keyframes) {
  for (std::size_t i = 0; i < kFrames; ++i) frames_[i].features = features[i];
  kept_.init(kept_keyframes);
}

void Window::clear() {
  for (Frame& frame : frames_) {
    const FrameFeatures features = frame.features;
    frame = Frame();
    frame.features = features;
  }
  keyframe_ = recent_ = last_ = older_ = lost_ = kNoFrame;
  recent_age_ = 0;
  last_motion_ = recent_motion_ = {};
  kept_.clear();
  T_world_depth_.reset();
}

Window::References Window::references() const {
  References references;
  const auto add = [&](int slot) { references.slots[references.count++] = slot; };
  if (!has_keyframe()) return references;
  add(keyframe_);
  if (has_recent()) add(recent_);
  if (has_older()) add(older_);
  return references;
}

void Window::set_pose(int slot, PoseWithCovariance pose) {
  (void)settle(pose);
  (*this)[slot].pose = pose;
}

MotionReference Window::from_keyframe(int slot) const {
  if (keyframe_ == kNoFrame || keyframe_ == slot) return {};
  const Matrix6& covariance = slot == older_    ? older_covariance_
                              : slot == recent_ ? recent_motion_.independent
                                                : last_motion_.independent;
  const Se3& T_world_frame = (*this)[slot].pose.T_world_camera;
  return {T_world_frame.inverse() * (*this)[keyframe_].pose.T_world_camera, covariance};
}

void Window::move_keyframe(const PoseWithCovariance& pose) {
  for (const int slot : {last_, older_, recent_ == last_ ? kNoFrame : recent_})
    if (slot != kNoFrame && slot != keyframe_)
      (*this)[slot].pose.T_world_camera =
          pose.T_world_camera * from_keyframe(slot).T_reference_base.inverse();
  set_pose(keyframe_, pose);
}

void Window::move_last(const PoseWithCovariance& pose, const Matrix6& covariance_keyframe_last) {
  if (keyframe_ != kNoFrame)
    move_keyframe(keyframe_ == last_ ? pose
                                     : plvo::advance(pose, from_keyframe(last_).T_reference_base.inverse(),
                                                     covariance_keyframe_last));
  set_pose(last_, pose);
  T_world_depth_.reset();
}

// Not inlined: its matrices would otherwise stay on the stack during the search for that keyframe.
[[gnu::noinline]] void Window::relocalise(int slot, const MotionEstimate& motion) {
  const PoseWithCovariance pose = plvo::advance((*this)[slot].pose, motion.T_current_reference, motion.C_H);
  move_last(pose, inverse_covariance(from_keyframe(last_).T_reference_base, last_motion_.total()));
  kept_.drop(slot);
}

void Window::change_world(const PoseWithCovariance& pose) {
  kept_.clear();
  drop_lost();
  if (has_last())
    move_last(pose, Matrix6::Zero());
  else
    set_pose(current_, pose);
}

void Window::remove_carried(const CarriedCells& cells) {
  for (Frame& frame : frames_) cells.remove_points(frame.features.points);
}

// Limits for one reference provide memory for the features of two frames: the reference and the current
// frame. The current frame takes over the memory of the last one unless that is the reference.
FrameFeatures& Window::begin_frame() {
  FrameFeatures& mine = (*this)[current_].features;
  for (int slot = 0; slot < static_cast<int>(kFrames) && mine.points.points.empty(); ++slot) {
    if (is_reference(slot)) continue;
    FrameFeatures& theirs = (*this)[slot].features;
    std::swap(mine, theirs);
    std::swap(mine.stamp_ns, theirs.stamp_ns);  // each keeps its own
  }
  return mine;
}

void Window::start(const PoseWithCovariance& pose) {
  set_pose(current_, pose);
  (*this)[current_].velocity = {};
  last_motion_ = recent_motion_ = {};
  keyframe_ = recent_ = last_ = current_;
  older_ = lost_ = kNoFrame;
  current_ = free_slot();
}

void Window::resume(int slot) {
  kept_.drop(slot);
  keyframe_ = recent_ = slot;
}

void Window::set_velocity(std::int64_t elapsed_ns) {
  Frame& last = (*this)[last_];
  Frame& current = (*this)[current_];
  const Se3 T_current_last = current.pose.T_world_camera.inverse() * last.pose.T_world_camera;
  current.velocity = {mean_velocity(T_current_last, static_cast<double>(elapsed_ns) * 1e-9), elapsed_ns};
  last.velocity = {velocity_between(last.velocity, current.velocity), elapsed_ns};
}

void Window::advance(const Kept& kept, bool keep_older) {
  lost_ = kNoFrame;
  if (!kept.older) older_ = kNoFrame;
  last_ = current_;
  if (!kept.keyframe) {
    if (keep_older) {
      const MotionReference last = from_keyframe(last_);
      older_covariance_ = inverse_covariance(last.T_reference_base, last.covariance);
      older_ = keyframe_;
    }
    last_motion_ = {};
    keyframe_ = last_;
  }
  ++recent_age_;
  if (!kept.recent) {
    recent_ = last_;
    recent_age_ = 0;
    recent_motion_ = last_motion_;
  }
  current_ = free_slot();
}

void Window::give_up() {
  keep_keyframe();
  keyframe_ = recent_ = older_ = lost_ = kNoFrame;
  last_motion_ = recent_motion_ = {};
}

// A keyframe from which no frame was tracked does not replace a kept one.
bool Window::keeps_keyframe() const { return (*this)[keyframe_].velocity.known() || !kept_.full(); }

void Window::keep_keyframe() {
  if (keeps_keyframe()) kept_.keep(keyframe_);
}

int Window::latest_kept() const {
  if (has_keyframe() && kept_.capacity() > 0 && keeps_keyframe()) return keyframe_;
  return kept_.empty() ? kNoFrame : kept_.latest();
}

bool Window::can_keep_lost() const {
  if (kept_.capacity() == 0) return false;
  for (int slot = 0; slot < static_cast<int>(kFrames); ++slot)
    if (slot != current_ && !is_reference(slot) && !(*this)[slot].features.points.points.empty()) return true;
  return false;
}

void Window::keep_lost(const PoseWithCovariance& pose) {
  set_pose(current_, pose);
  Frame& lost = (*this)[current_];
  lost.velocity = {};
  lost_ = current_;
  current_ = free_slot();
}

void Window::go_on_from_lost() {
  keep_keyframe();
  keyframe_ = recent_ = last_ = lost_;
  older_ = lost_ = kNoFrame;
  last_motion_ = recent_motion_ = {};
}

bool Window::is_reference(int slot) const {
  return slot == keyframe_ || slot == recent_ || slot == older_ || slot == lost_ || kept_.holds(slot);
}

int Window::free_slot() const {
  int slot = 0;
  while (slot == last_ || is_reference(slot)) ++slot;
  return slot;
}

}  // namespace plvo
