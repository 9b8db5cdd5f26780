// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/paced_camera.hpp"

namespace plvo {

Status PacedCamera::next(RgbdFrame& frame) {
  if (pace_ == Pace::kStep && !wait_for_step_()) return {StatusCode::kEndOfStream, "stopped by the user"};
  const Status status = camera_.next(frame);
  if (!status.ok() || pace_ != Pace::kRealtime) return status;
  if (!started_) {
    started_ = true;
    clock_minus_stamp_ns_ = clock_.monotonic_ns() - frame.stamp_ns;
  }
  clock_.sleep_until_ns(frame.stamp_ns + clock_minus_stamp_ns_);
  return status;
}

}  // namespace plvo
