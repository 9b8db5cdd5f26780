// SPDX-License-Identifier: Apache-2.0
// Delivers the frames of any camera at a chosen pace. Realtime delivers a frame no earlier than its stamp,
// counted from the first one. No frame is dropped: a slow caller falls behind, and catches up where the
// recording has gaps.
#pragma once

#include <cstdint>
#include <functional>

#include "plvo/hal/clock.hpp"
#include "plvo/hal/rgbd_camera.hpp"

namespace plvo {

enum class Pace : std::uint8_t { kFast, kRealtime, kStep };

class PacedCamera final : public RgbdCamera {
 public:
  // All three objects are borrowed. wait_for_step: called before each frame with Pace::kStep; false ends the
  // stream.
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
