// SPDX-License-Identifier: Apache-2.0
// The record of a landmark of a reference: in how many frames it agreed with the camera's motion. A landmark
// that mostly did not is part of a moving object, is a reflection, or has a wrong depth. It is still matched
// and tested, but it is no evidence for a motion (coverage.hpp). A landmark that agreed for some frames is
// proven: where others contradict the proven ones, the proven ones decide (motion_estimator.hpp).
#pragma once

#include <algorithm>
#include <cstdint>

namespace plvo {

class LandmarkRecord {
 public:
  // Balance from which a landmark is proven. From one frame to the next an object that enters the view moves
  // by about as much as the rest of the view leaves open, and its landmarks agree with a motion between both.
  // After three frames they do not.
  static constexpr int kProven = 3;

  LandmarkRecord() = default;
  explicit LandmarkRecord(int balance)
      : balance_(static_cast<std::int8_t>(std::clamp(balance, -kMost, int{kMost}))) {}

  // Frames in which it agreed with the motion, minus those in which it did not; within ±kMost.
  int balance() const { return balance_; }
  bool trusted() const { return balance_ >= 0; }
  bool proven() const { return balance_ >= kProven; }
  // Takes in one frame in which the landmark was found.
  void add(bool agreed) { *this = LandmarkRecord(balance_ + (agreed ? 1 : -1)); }

 private:
  static constexpr int kMost = 2 * kProven;
  std::int8_t balance_ = 0;
};

}  // namespace plvo
