// SPDX-License-Identifier: Apache-2.0
// Keeps the time of a frame within a budget. After a frame that took too long, the next ones have fewer
// features, in steps of a fixed order. After many frames with time to spare, the number rises by one step. No
// clock is read here: the caller reports the duration of a frame (Odometry::frame_took), and the same reports
// give the same steps.
#pragma once

#include <cstddef>
#include <cstdint>

#include "plvo/odometry/config.hpp"

namespace plvo {

// Capacity for the features of a frame.
struct FeatureCapacity {
  std::size_t keypoints = 0;
  std::size_t segments = 0;
};

class FeatureBudget {
 public:
  // Each step removes a quarter: of the keypoints, of the segments, of the keypoints, … After the last step a
  // third of each is left.
  static constexpr int kSteps = 8;
  // After a step this many frames are not judged: their references still have the previous number of
  // features.
  static constexpr int kSettlingFrames = 2;

  void init(const BudgetConfig& config, const Limits& limits);

  // Takes in the duration of the last frame. It has no effect without a budget.
  void note(std::int64_t took_ns);

  int step() const { return step_; }  // 0: all that fit, … kSteps
  FeatureCapacity capacity() const { return capacity_of(step_); }

 private:
  FeatureCapacity capacity_of(int step) const;
  void move_to(int step);

  BudgetConfig config_;
  FeatureCapacity all_;
  int step_ = 0;
  int settling_ = 0;
  int quick_frames_ = 0;  // in a row
};

}  // namespace plvo
