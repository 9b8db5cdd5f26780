// SPDX-License-Identifier: Apache-2.0
// The frames that the odometry keeps: their roles, their poses in the world, and their relative poses. The
// window decides nothing: the caller assigns the roles.
//
//   current   the frame that is being tracked
//   last      the last frame that has a pose; it and the frame before give the velocity
//   keyframe  the base of the estimate: the current pose is chained to it
//   recent    a later frame that is matched beside the keyframe; without one, the keyframe itself
//   older     the keyframe before, which is still matched (ReferencePolicy::kWindow)
//   kept      keyframes from before a loss, which may come back into view (kept_keyframes.hpp)
//   lost      the last lost frame, with which the next one is matched if the references fail
//
// One frame can have several roles. Slots identify the frames. Memory: the features of as many frames as
// Limits ask for, from the arena; two frames without a role share it (begin_frame()).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/motion/motion_estimator.hpp"
#include "plvo/odometry/features/frame_features.hpp"
#include "plvo/odometry/motion_model.hpp"
#include "plvo/odometry/window/kept_keyframes.hpp"
#include "plvo/odometry/window/pose_with_covariance.hpp"
#include "plvo/points/carried_cells.hpp"

namespace plvo {

class Window {
 public:
  static constexpr int kNoFrame = -1;
  // The current and the last frame, the references and the kept keyframes.
  static constexpr std::size_t kFrames = 2 + kMostOtherFrames;

  struct Frame {
    FrameFeatures features;  // the current frame has only these until it is tracked
    PoseWithCovariance pose;
    // Mean velocity since the last good frame before. When the next frame is tracked, it becomes the mean
    // over the intervals before and after this frame.
    Velocity velocity;
  };
  // Covariance of T_frame_keyframe.
  struct RelativeCovariance {
    Matrix6 independent = Matrix6::Zero();  // weight against the matches with the keyframe
    Matrix6 common_mode = Matrix6::Zero();  // in addition: common_mode_error.hpp
    Matrix6 total() const { return independent + common_mode; }
  };
  // Which references are still matched.
  struct Kept {
    bool keyframe = false, recent = false, older = false;
  };

  // Memory for the features of as many frames as Limits ask for; an arena without memory counts the bytes.
  using Features = std::array<FrameFeatures, kFrames>;
  static constexpr void allocate(Arena& memory, const Limits& limits, Features& features) {
    for (std::size_t i = 0; i <= static_cast<std::size_t>(limits.references + limits.kept_keyframes); ++i)
      features[i].allocate(memory, limits);
  }
  void init(const Features& features, int kept_keyframes);
  // Forgets all poses and roles; the memory, and which frame is current, stay.
  void clear();
  // Restores the state after init().
  void reset() {
    clear();
    current_ = 0;
  }

  int current() const { return current_; }
  int last() const { return last_; }
  int keyframe() const { return keyframe_; }
  int recent() const { return recent_; }
  int older() const { return older_; }
  // The frame that the current pose is chained to: the keyframe or, without one, the last frame.
  int base() const { return has_keyframe() ? keyframe_ : last_; }
  bool has_last() const { return last_ != kNoFrame; }
  bool has_keyframe() const { return keyframe_ != kNoFrame; }
  bool has_recent() const { return recent_ != keyframe_; }
  bool has_older() const { return older_ != kNoFrame; }
  int lost() const { return lost_; }
  bool has_lost() const { return lost_ != kNoFrame; }
  const KeptKeyframes& kept() const { return kept_; }
  // The frames that the current one is matched with: the keyframe, which is the base, then the
  // recent frame and the older keyframe if there are any.
  struct References {
    std::array<int, kMaxReferences> slots{};
    std::size_t count = 0;
    std::span<const int> span() const { return std::span(slots).first(count); }
  };
  References references() const;
  // The recent frame is matched for at most this many frames. Points are searched only in frames that will be
  // matched, and where registration fails.
  static constexpr int kRecentFrames = 3;
  // Whether there is a recent frame that may be matched once more.
  bool recent_is_young() const { return has_recent() && recent_age_ + 1 < kRecentFrames; }

  Frame& operator[](int slot) { return frames_[static_cast<std::size_t>(slot)]; }
  const Frame& operator[](int slot) const { return frames_[static_cast<std::size_t>(slot)]; }

  Frame& current_frame() { return (*this)[current_]; }
  const Frame& current_frame() const { return (*this)[current_]; }
  Frame& last_frame() { return (*this)[last_]; }
  const Frame& last_frame() const { return (*this)[last_]; }

  // Stores the pose of a frame, with its covariance within the bound of covariance.hpp. A pose that is not
  // finite is stored unchanged: the check of the results finds it.
  void set_pose(int slot, PoseWithCovariance pose);
  // T_frame_keyframe with its covariance in the estimate; the identity for the keyframe, or without one.
  MotionReference from_keyframe(int slot) const;
  // Covariance of T_last_keyframe.
  const RelativeCovariance& last_motion() const { return last_motion_; }
  const RelativeCovariance& recent_motion() const { return recent_motion_; }
  // Corrects the keyframe's pose. The last, recent and older frames keep their poses relative to it.
  void move_keyframe(const PoseWithCovariance& pose);
  // Moves all poses so that the last frame is where `motion` leads from a kept keyframe, which is dropped.
  void relocalise(int slot, const MotionEstimate& motion);
  // Gives the last frame, or without one the current frame, a pose in another world. The keyframe moves with
  // it; the lost and the kept frames stay behind and are dropped.
  void change_world(const PoseWithCovariance& pose);
  // Pose of the camera when the latest depth image came; empty if the poses have been moved since.
  const std::optional<Se3>& T_world_depth() const { return T_world_depth_; }
  // The latest depth image came with the last frame.
  void note_depth() { T_world_depth_ = last_frame().pose.T_world_camera; }

  // Removes the 3D points in carried cells from all frames.
  void remove_carried(const CarriedCells& cells);

  // Gives the current frame memory for its features.
  FrameFeatures& begin_frame();
  // Makes the current frame the keyframe and the last frame, without a motion before it.
  void start(const PoseWithCovariance& pose);
  // Makes a kept keyframe the keyframe again.
  void resume(int slot);
  // The kept keyframes in turn; there must be one.
  int next_kept() { return kept_.next(); }
  // Stores the covariance of T_current_keyframe of the tracked frame.
  void set_motion(const RelativeCovariance& covariance) { last_motion_ = covariance; }
  // Computes the velocity of the current frame from its pose and the last frame's, elapsed_ns apart; it also
  // refines the velocity of the last frame.
  void set_velocity(std::int64_t elapsed_ns);
  // Makes the current frame the last one and gives it the roles that are not kept. keep_older: a replaced
  // keyframe becomes the older one.
  void advance(const Kept& kept, bool keep_older);
  // No reference is in view any more: the keyframe joins the kept ones, and its role stays empty.
  void give_up();
  // The kept keyframe that would be the latest if the references were given up now; kNoFrame if
  // there would be none.
  int latest_kept() const;

  // Whether the current frame can stay as the lost one: there is memory for the next frame, and a place where
  // the keyframe can be kept if tracking goes on from the lost frame.
  bool can_keep_lost() const;
  // Makes the current frame the lost one, with this pose.
  void keep_lost(const PoseWithCovariance& pose);
  void drop_lost() { lost_ = kNoFrame; }
  // Makes the lost frame the keyframe and the last frame; the old keyframe joins the kept ones.
  void go_on_from_lost();

 private:
  // Corrects the last frame's pose. The keyframe, if there is one, moves with it; its new covariance includes
  // that of T_keyframe_last, which the caller gives.
  void move_last(const PoseWithCovariance& pose, const Matrix6& covariance_keyframe_last);
  bool keeps_keyframe() const;
  bool is_reference(int slot) const;
  int free_slot() const;
  void keep_keyframe();

  std::array<Frame, kFrames> frames_;
  int current_ = 0;
  int last_ = kNoFrame;
  int keyframe_ = kNoFrame;
  int recent_ = kNoFrame;
  int older_ = kNoFrame;
  int lost_ = kNoFrame;
  int recent_age_ = 0;
  // Zero while the frame is the keyframe.
  RelativeCovariance last_motion_, recent_motion_;
  Matrix6 older_covariance_ = Matrix6::Zero();
  KeptKeyframes kept_;
  std::optional<Se3> T_world_depth_;
};

}  // namespace plvo
