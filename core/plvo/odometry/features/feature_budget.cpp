// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/features/feature_budget.hpp"

namespace plvo {
namespace {

// A frame with fewer features than these cannot serve as a reference.
constexpr std::size_t kLeastKeypoints = 40;
constexpr std::size_t kLeastSegments = 16;

std::size_t without_quarters(std::size_t count, int quarters, std::size_t least) {
  std::size_t left = count;
  for (int i = 0; i < quarters; ++i) left -= left / 4;
  if (left < least) left = least;
  return left < count ? left : count;
}

}  // namespace

void FeatureBudget::init(const BudgetConfig& config, const Limits& limits) {
  *this = {};
  config_ = config;
  all_ = {static_cast<std::size_t>(limits.keypoints), static_cast<std::size_t>(limits.segments)};
}

FeatureCapacity FeatureBudget::capacity_of(int step) const {
  return {without_quarters(all_.keypoints, (step + 1) / 2, kLeastKeypoints),
          without_quarters(all_.segments, step / 2, kLeastSegments)};
}

void FeatureBudget::note(std::int64_t took_ns) {
  if (config_.frame_ns <= 0) return;
  if (settling_ > 0) {
    --settling_;
    return;
  }
  if (took_ns > config_.frame_ns) {
    move_to(step_ + 1);
    return;
  }
  const bool quick =
      static_cast<double>(took_ns) < config_.spare_share * static_cast<double>(config_.frame_ns);
  quick_frames_ = quick ? quick_frames_ + 1 : 0;
  if (quick_frames_ >= config_.patience_frames) move_to(step_ - 1);
}

void FeatureBudget::move_to(int step) {
  quick_frames_ = 0;
  if (step < 0 || step > kSteps) return;
  step_ = step;
  settling_ = kSettlingFrames;
}

}  // namespace plvo
