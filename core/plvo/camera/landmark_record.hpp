// SPDX-License-Identifier: Apache-2.0
// How a landmark of a reference has moved so far: as the camera's motion says, or otherwise. What moves
// otherwise belongs to an object of its own, is a reflection, or has a wrong depth. Its features are still
// matched and tested, but they are no evidence for a motion (coverage.hpp).
#pragma once

#include <algorithm>
#include <cstdint>

namespace plvo {

class LandmarkRecord {
 public:
  LandmarkRecord() = default;
  explicit LandmarkRecord(int balance)
      : balance_(static_cast<std::int8_t>(std::clamp(balance, -kMost, int{kMost}))) {}

  // Frames in which it agreed with the motion, less those in which it did not; at most kMost of either.
  int balance() const { return balance_; }
  bool trusted() const { return balance_ >= 0; }
  // Takes in one frame in which the landmark was found.
  void add(bool agreed) { *this = LandmarkRecord(balance_ + (agreed ? 1 : -1)); }

 private:
  static constexpr int kMost = 4;
  std::int8_t balance_ = 0;
};

}  // namespace plvo
