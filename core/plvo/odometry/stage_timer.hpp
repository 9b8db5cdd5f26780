// SPDX-License-Identifier: Apache-2.0
// Adds the time that a scope takes to one stage's account, by the clock of Config; without one it does
// nothing.
#pragma once

#include <cstdint>

#include "plvo/odometry/track_result.hpp"

namespace plvo {

class StageTimer {
 public:
  using Clock = std::int64_t (*)();

  StageTimer(Clock clock, TrackResult& result, Stage stage)
      : clock_(clock), account_(result.stage_ns[static_cast<std::size_t>(stage)]) {
    if (clock_ != nullptr) start_ns_ = clock_();
  }
  ~StageTimer() {
    if (clock_ != nullptr) account_ += clock_() - start_ns_;
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  Clock clock_;
  std::int64_t& account_;
  std::int64_t start_ns_ = 0;
};

}  // namespace plvo
