// SPDX-License-Identifier: Apache-2.0
// Any camera at a chosen pace. Realtime gives each frame out no earlier than its stamp says, counted from the
// first one; nothing is dropped: who is too slow falls behind, and catches up where the recording has gaps.
#pragma once

#include <cstdint>
#include <functional>

#include "plvo/hal/clock.hpp"
#include "plvo/hal/rgbd_camera.hpp"

namespace plvo {

enum class Pace : std::uint8_t { kFast, kRealtime, kStep };

class PacedCamera final : public RgbdCamera {
 public:
  // All three are borrowed. wait_for_step: called before each frame of Pace::kStep; false ends the stream.
  PacedCamera(RgbdCamera& camera, Pace pace, Clock& clock, std::function<bool()> wait_for_step)
      : camera_(camera), pace_(pace), clock_(clock), wait_for_step_(std::move(wait_for_step)) {}

  CameraModel model() const override { return camera_.model(); }
  Status next(RgbdFrame& frame) override;

 private:
  RgbdCamera& camera_;
  Pace pace_;
  Clock& clock_;
  std::function<bool()> wait_for_step_;
  bool started_ = false;
  std::int64_t clock_minus_stamp_ns_ = 0;
};

}  // namespace plvo
