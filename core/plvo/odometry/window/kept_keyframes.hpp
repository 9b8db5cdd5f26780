// SPDX-License-Identifier: Apache-2.0
// Keyframes that were in use when the camera was lost. The motion is unobserved until tracking resumes; when
// the view of a kept keyframe comes back, its pose is usable again. The list holds slots of the odometry's
// frames; a new one replaces the oldest.
#pragma once

#include <array>
#include <cstddef>

namespace plvo {

// Upper bound of Limits::kept_keyframes, and of its sum with Limits::references.
inline constexpr int kMostKeptKeyframes = 4;
inline constexpr int kMostOtherFrames = 6;

class KeptKeyframes {
 public:
  void init(int capacity) { capacity_ = capacity; }
  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }
  int latest() const { return slots_[static_cast<std::size_t>(count_ - 1)]; }

  bool holds(int slot) const {
    for (int i = 0; i < count_; ++i)
      if (slots_[static_cast<std::size_t>(i)] == slot) return true;
    return false;
  }
  void keep(int slot) {
    if (capacity_ == 0 || holds(slot)) return;
    if (count_ == capacity_) drop(slots_[0]);
    slots_[static_cast<std::size_t>(count_++)] = slot;
  }
  void drop(int slot) {
    int kept = 0;
    for (int i = 0; i < count_; ++i)
      if (slots_[static_cast<std::size_t>(i)] != slot)
        slots_[static_cast<std::size_t>(kept++)] = slots_[static_cast<std::size_t>(i)];
    count_ = kept;
  }
  // Returns the slots in rotation; the list must not be empty.
  int next() {
    turn_ = (turn_ + 1) % count_;
    return slots_[static_cast<std::size_t>(turn_)];
  }

 private:
  std::array<int, kMostKeptKeyframes> slots_{};
  int capacity_ = 0;
  int count_ = 0;
  int turn_ = 0;
};

}  // namespace plvo
