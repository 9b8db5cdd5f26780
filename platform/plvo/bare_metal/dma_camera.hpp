// SPDX-License-Identifier: Apache-2.0
// A complete camera implementation for a board. A DMA engine writes frames into buffers that the board's
// program owns, and the odometry reads them in place, including padded rows. There are three buffers: one is
// being written, one is complete, one is lent to the odometry. next() returns the newest complete frame.
//
// The sensor's interrupt calls on_frame_complete() and points the engine at writing(); next() is for the main
// program. Neither blocks the other.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "plvo/hal/clock.hpp"
#include "plvo/hal/rgbd_camera.hpp"

namespace plvo::bare_metal {

// Destination of one frame: the address of each image's first pixel. The depth image must be registered to
// the colour image.
struct DmaBuffer {
  std::uint8_t* colour = nullptr;
  std::uint16_t* depth = nullptr;
};

// Format of the sensor's frames. Rows may be padded, because DMA engines often transfer whole bursts.
struct DmaLayout {
  PixelFormat format = PixelFormat::kGray8;
  std::ptrdiff_t colour_stride_bytes = 0;
  std::ptrdiff_t depth_stride_bytes = 0;  // even
  double metres_per_unit = 0.001;
};

class DmaCamera final : public RgbdCamera {
 public:
  static constexpr std::size_t kBuffers = 3;
  // Called before the processor reads data that the engine wrote. With the data cache on, it must invalidate
  // these addresses (SCB_InvalidateDCache_by_Addr; buffers must therefore start and end on a cache line).
  // Otherwise nullptr.
  using Invalidate = void (*)(const void* start, std::size_t bytes);

  // clock must outlive the camera; its time is independent of the stamps of the frames.
  DmaCamera(const CameraModel& model, const DmaLayout& layout, const std::array<DmaBuffer, kBuffers>& buffers,
            Clock& clock, Invalidate invalidate = nullptr);

  CameraModel model() const override { return model_; }
  // Waits at most half a second, then returns kTimeout.
  Status next(RgbdFrame& frame) override;

  // To be called by the interrupt at the end of a transfer: the buffer writing() contains the frame with this
  // stamp. Afterwards writing() is another buffer.
  void on_frame_complete(std::int64_t stamp_ns);
  const DmaBuffer& writing() const { return buffers_[writing_]; }

 private:
  static constexpr std::uint8_t kFresh = 0x80;  // flag added to a buffer's number: not yet lent

  CameraModel model_;
  DmaLayout layout_;
  std::array<DmaBuffer, kBuffers> buffers_;
  std::array<std::int64_t, kBuffers> stamps_ns_{};
  Clock& clock_;
  Invalidate invalidate_;
  std::uint8_t writing_ = 0;               // used by the interrupt only
  std::atomic<std::uint8_t> complete_{1};  // shared by interrupt and main program
  std::uint8_t lent_ = 2;                  // used by the main program only
};

}  // namespace plvo::bare_metal
