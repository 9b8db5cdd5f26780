// SPDX-License-Identifier: Apache-2.0
// Keyframes that were in use when the camera was lost. Nothing tells how far it moves until it sees again:
// but when one of their views comes back, so does what was known of the pose. A list of slots of the
// odometry's frames; the one that was kept longest makes way for a new one.
#pragma once

#include <array>
#include <cstddef>

namespace plvo {

// What Limits::kept_keyframes may ask for, and that and Limits::references together.
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
  // Each in its turn; there must be one.
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
