// SPDX-License-Identifier: Apache-2.0
// Image source of OpenNi2Camera: a sensor in this process, or a recording that another process reads.
// Internal to this module.
#pragma once

#include <cstddef>
#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/openni2/frame_pairer.hpp"
#include "plvo/openni2/openni2_camera.hpp"

namespace plvo {

enum class ImageFormat : std::uint8_t { kRgb888, kGray8, kDepth1Mm, kDepth100Um };

constexpr std::size_t bytes_per_pixel(ImageFormat format) {
  return format == ImageFormat::kRgb888 ? 3 : format == ImageFormat::kGray8 ? 1 : 2;
}

struct StreamFormat {
  int width = 0, height = 0, fps = 0;
  ImageFormat format = ImageFormat::kRgb888;
  double fov_x_rad = 0, fov_y_rad = 0;
  bool mirrored = false;  // the driver cannot disable mirroring: rows are reversed when copied

  std::size_t row_bytes() const { return static_cast<std::size_t>(width) * bytes_per_pixel(format); }
  std::size_t image_bytes() const { return row_bytes() * static_cast<std::size_t>(height); }
};

struct DeviceImage {
  FramePairer::Stream stream = FramePairer::kColour;
  int index = 0;  // the device's frame index of this stream
  int width = 0, height = 0;
  std::int64_t stamp_us = 0;
  const std::uint8_t* data = nullptr;  // null: incomplete, or not of the stream's size and format
  std::ptrdiff_t stride_bytes = 0;
};

class ImageDevice {
 public:
  enum class Wait : std::uint8_t {
    kImage,
    kTimeout,
    kError,   // temporary failure: gone() or a later call gives the reason
    kBroken,  // permanent failure: failure() gives the reason
  };
  virtual ~ImageDevice() = default;

  virtual Status start() = 0;
  // The image is valid until the next call.
  virtual Wait wait(int timeout_ms, DeviceImage& image) = 0;
  virtual Status failure() const { return {}; }

  virtual const StreamFormat& colour_format() const = 0;
  virtual const StreamFormat& depth_format() const = 0;
  virtual const OpenNi2DeviceInfo& info() const = 0;
  virtual bool is_file() const = 0;
  virtual bool registered() const = 0;
  virtual bool gone() const { return false; }
  virtual bool at_end() const { return false; }
  virtual int recorded_frames() = 0;
};

}  // namespace plvo
