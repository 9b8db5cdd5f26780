// SPDX-License-Identifier: Apache-2.0
// What the stages of a frame have in common, and the time that they take.
#pragma once

#include <cstdint>

#include "plvo/base/arena.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/parallax_check.hpp"
#include "plvo/odometry/stage.hpp"
#include "plvo/odometry/tracking/noise_scales.hpp"
#include "plvo/points/carried_cells.hpp"

namespace plvo {

struct StageContext {
  const CameraModel& camera;
  const Config& config;
  const NoiseScales& noise;  // learnt so far
  Arena& scratch;
  StageTimes& times;              // of this frame
  CarriedCells& carried;          // found so far
  const ParallaxCheck* parallax;  // null: the depth image is an old one, and cannot be asked
};

// Adds the duration of a scope to the time of a stage, by the clock of Config, and calls Config's hook at its
// end. Without clock and hook it does nothing.
class StageTimer {
 public:
  StageTimer(const StageContext& context, Stage stage) : context_(context), stage_(stage) {
    if (config().stage_clock != nullptr) start_ns_ = config().stage_clock();
  }
  ~StageTimer() {
    if (config().stage_clock != nullptr)
      context_.times[static_cast<std::size_t>(stage_)] += config().stage_clock() - start_ns_;
    if (config().stage_hook.call != nullptr) config().stage_hook.call(config().stage_hook.context, stage_);
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  const Config& config() const { return context_.config; }

  const StageContext& context_;
  Stage stage_;
  std::int64_t start_ns_ = 0;
};

}  // namespace plvo
