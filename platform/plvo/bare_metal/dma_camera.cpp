// SPDX-License-Identifier: Apache-2.0
#include "plvo/bare_metal/dma_camera.hpp"

namespace plvo::bare_metal {
namespace {

constexpr std::int64_t kTimeLimit_ns = 500'000'000;

}  // namespace

DmaCamera::DmaCamera(const CameraModel& model, const DmaLayout& layout,
                     const std::array<DmaBuffer, kBuffers>& buffers, Clock& clock, Invalidate invalidate)
    : model_(model), layout_(layout), buffers_(buffers), clock_(clock), invalidate_(invalidate) {}

void DmaCamera::on_frame_complete(std::int64_t stamp_ns) {
  stamps_ns_[writing_] = stamp_ns;
  // The release order makes stamp and pixels visible before the buffer's number. The returned buffer is free
  // for writing.
  const auto number = static_cast<std::uint8_t>(writing_ | kFresh);
  writing_ = complete_.exchange(number, std::memory_order_acq_rel) & 3;
}

Status DmaCamera::next(RgbdFrame& frame) {
  const std::int64_t give_up_ns = clock_.monotonic_ns() + kTimeLimit_ns;
  while ((complete_.load(std::memory_order_relaxed) & kFresh) == 0) {
    const std::int64_t now_ns = clock_.monotonic_ns();
    if (now_ns >= give_up_ns)
      return {StatusCode::kTimeout, "no frame came in half a second: is the sensor's transfer running?"};
    clock_.sleep_until_ns(now_ns + 1'000'000);
  }
  lent_ = complete_.exchange(lent_, std::memory_order_acq_rel) & 3;
  const DmaBuffer& buffer = buffers_[lent_];
  const auto height = static_cast<std::size_t>(model_.height);
  if (invalidate_ != nullptr) {
    invalidate_(buffer.colour, height * static_cast<std::size_t>(layout_.colour_stride_bytes));
    invalidate_(buffer.depth, height * static_cast<std::size_t>(layout_.depth_stride_bytes));
  }
  frame.stamp_ns = frame.depth_stamp_ns = stamps_ns_[lent_];
  frame.colour = {buffer.colour, model_.width, model_.height, layout_.colour_stride_bytes, layout_.format};
  frame.depth = {buffer.depth, model_.width, model_.height, layout_.depth_stride_bytes / 2,
                 layout_.metres_per_unit};
  return {};
}

}  // namespace plvo::bare_metal
