// SPDX-License-Identifier: Apache-2.0
// A camera of one's own on a board, complete: a DMA engine writes frames into buffers that the board's
// program owns, and the odometry reads them where they lie, padded rows and all. Three buffers take turns:
// one is being written, one is complete, one is lent to the odometry; the newest complete frame is the one
// that counts.
//
// The sensor's interrupt calls on_frame_complete() and points the engine at writing(); next() is for the main
// program. Neither waits for the other.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "plvo/hal/clock.hpp"
#include "plvo/hal/rgbd_camera.hpp"

namespace plvo::bare_metal {

// Where the engine puts one frame: each image's first pixel. The depth image is registered to the colour
// image.
struct DmaBuffer {
  std::uint8_t* colour = nullptr;
  std::uint16_t* depth = nullptr;
};

// What every frame of the sensor looks like. Rows may be longer than their pixels: engines like whole bursts.
struct DmaLayout {
  PixelFormat format = PixelFormat::kGray8;
  std::ptrdiff_t colour_stride_bytes = 0;
  std::ptrdiff_t depth_stride_bytes = 0;  // even
  double metres_per_unit = 0.001;
};

class DmaCamera final : public RgbdCamera {
 public:
  static constexpr std::size_t kBuffers = 3;
  // Called before the processor reads what the engine wrote. With the data cache on it must forget those
  // addresses (SCB_InvalidateDCache_by_Addr; so buffers start and end on a cache line); otherwise nullptr.
  using Invalidate = void (*)(const void* start, std::size_t bytes);

  // clock must outlive the camera; its stamps and those of the frames have nothing to do with each other.
  DmaCamera(const CameraModel& model, const DmaLayout& layout, const std::array<DmaBuffer, kBuffers>& buffers,
            Clock& clock, Invalidate invalidate = nullptr);

  CameraModel model() const override { return model_; }
  // Waits at most half a second: kTimeout then.
  Status next(RgbdFrame& frame) override;

  // For the interrupt that ends a transfer: the buffer writing() holds the frame of this time. Afterwards
  // writing() is another one.
  void on_frame_complete(std::int64_t stamp_ns);
  const DmaBuffer& writing() const { return buffers_[writing_]; }

 private:
  static constexpr std::uint8_t kFresh = 0x80;  // beside a buffer's number: not yet lent

  CameraModel model_;
  DmaLayout layout_;
  std::array<DmaBuffer, kBuffers> buffers_;
  std::array<std::int64_t, kBuffers> stamps_ns_{};
  Clock& clock_;
  Invalidate invalidate_;
  std::uint8_t writing_ = 0;               // the interrupt's alone
  std::atomic<std::uint8_t> complete_{1};  // changes hands between the two
  std::uint8_t lent_ = 2;                  // the main program's alone
};

}  // namespace plvo::bare_metal
