// SPDX-License-Identifier: Apache-2.0
// Adds the duration of a scope to the time of a stage, by the clock of Config, and calls Config's hook at its
// end. Without clock and hook it does nothing.
#pragma once

#include <cstdint>

#include "plvo/odometry/config.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo {

class StageTimer {
 public:
  StageTimer(const Config& config, TrackResult& result, Stage stage)
      : config_(config), result_(result), stage_(stage) {
    if (config_.stage_clock != nullptr) start_ns_ = config_.stage_clock();
  }
  ~StageTimer() {
    if (config_.stage_clock != nullptr)
      result_.stage_ns[static_cast<std::size_t>(stage_)] += config_.stage_clock() - start_ns_;
    if (config_.stage_hook.call != nullptr) config_.stage_hook.call(config_.stage_hook.context, stage_);
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  const Config& config_;
  TrackResult& result_;
  Stage stage_;
  std::int64_t start_ns_ = 0;
};

}  // namespace plvo
