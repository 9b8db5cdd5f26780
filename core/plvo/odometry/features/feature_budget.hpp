// SPDX-License-Identifier: Apache-2.0
// Time that keeps its promise: after a frame that took too long the next ones have fewer features, in steps
// of a fixed order, and after many frames with time to spare one step more again. No clock is read here: the
// caller says what a frame took (Odometry::frame_took), and the same words give the same steps.
#pragma once

#include <cstddef>
#include <cstdint>

#include "plvo/odometry/config.hpp"

namespace plvo {

// How many features of a frame are kept.
struct FeatureCapacity {
  std::size_t keypoints = 0;
  std::size_t segments = 0;
};

class FeatureBudget {
 public:
  // Each takes a quarter: of the keypoints, of the segments, of the keypoints, … After the last of them a
  // third of either is left.
  static constexpr int kSteps = 8;
  // After a step so many frames are not judged: they are matched with references that are as full as before.
  static constexpr int kSettlingFrames = 2;

  void init(const BudgetConfig& config, const Limits& limits);

  // What the last frame took. Without a budget it has no effect.
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
