// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/freenect_driver/driver_stream.hpp"

#include <algorithm>
#include <cstring>

namespace plvo {
namespace {

constexpr int kMaxDepth_mm = 10000;

template <typename T>
OniStatus answer(const T& value, void* data, int* size) {
  if (data == nullptr || size == nullptr || *size < static_cast<int>(sizeof(T)))
    return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(T));
  *size = static_cast<int>(sizeof(T));
  return ONI_STATUS_OK;
}

// Reads a value of the property's type from the caller's memory, which need not be aligned.
template <typename T>
bool read(const void* data, int size, T& value) {
  if (data == nullptr || size < static_cast<int>(sizeof(T))) return false;
  std::memcpy(&value, data, sizeof(T));
  return true;
}

bool same(const OniVideoMode& a, const OniVideoMode& b) {
  return a.pixelFormat == b.pixelFormat && a.resolutionX == b.resolutionX && a.resolutionY == b.resolutionY &&
         a.fps == b.fps;
}

}  // namespace

DriverStream::DriverStream(OniSensorType sensor, std::span<const OniVideoMode> modes, FieldOfView fov)
    : sensor_(sensor), modes_(modes), fov_(fov), mode_(modes.front()) {}

int DriverStream::bytes_per_pixel(OniPixelFormat format) {
  if (format == ONI_PIXEL_FORMAT_RGB888) return 3;
  return format == ONI_PIXEL_FORMAT_GRAY8 ? 1 : 2;
}

OniVideoMode DriverStream::mode() const {
  const std::lock_guard lock(mutex_);
  return mode_;
}

OniStatus DriverStream::getProperty(int id, void* data, int* size) {
  const OniVideoMode now = mode();
  const bool is_depth = sensor_ == ONI_SENSOR_DEPTH;
  const int units_per_mm = now.pixelFormat == ONI_PIXEL_FORMAT_DEPTH_100_UM ? 10 : 1;
  // The range of the 16-bit image is also a limit.
  const int max_value = std::min(kMaxDepth_mm * units_per_mm, 65535);
  switch (id) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE: return answer(now, data, size);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV: return answer(fov_.x_rad, data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV: return answer(fov_.y_rad, data, size);
    case ONI_STREAM_PROPERTY_MIRRORING:
      return answer(static_cast<OniBool>(mirrored_ ? TRUE : FALSE), data, size);
    case ONI_STREAM_PROPERTY_CROPPING:
      return answer(OniCropping{FALSE, 0, 0, now.resolutionX, now.resolutionY}, data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return answer(now.resolutionX * bytes_per_pixel(now.pixelFormat), data, size);
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return is_depth ? answer(max_value, data, size) : ONI_STATUS_NOT_SUPPORTED;
    case ONI_STREAM_PROPERTY_MIN_VALUE: return is_depth ? answer(0, data, size) : ONI_STATUS_NOT_SUPPORTED;
    default: return ONI_STATUS_NOT_SUPPORTED;
  }
}

OniStatus DriverStream::setProperty(int id, const void* data, int size) {
  if (id == ONI_STREAM_PROPERTY_VIDEO_MODE) {
    OniVideoMode wanted;
    if (!read(data, size, wanted)) return ONI_STATUS_BAD_PARAMETER;
    const std::lock_guard lock(mutex_);
    if (running_ && !same(wanted, mode_)) return ONI_STATUS_OUT_OF_FLOW;
    const auto found = std::find_if(modes_.begin(), modes_.end(),
                                    [&](const OniVideoMode& mode) { return same(mode, wanted); });
    if (found == modes_.end()) return ONI_STATUS_NOT_SUPPORTED;
    mode_ = *found;
    return ONI_STATUS_OK;
  }
  if (id == ONI_STREAM_PROPERTY_MIRRORING) {
    OniBool wanted = FALSE;
    if (!read(data, size, wanted)) return ONI_STATUS_BAD_PARAMETER;
    if ((wanted != FALSE) == mirrored_) return ONI_STATUS_OK;
    if (!set_mirrored(wanted != FALSE)) return ONI_STATUS_NOT_SUPPORTED;
    mirrored_ = wanted != FALSE;
    return ONI_STATUS_OK;
  }
  if (id == ONI_STREAM_PROPERTY_CROPPING) {
    OniCropping wanted;
    if (!read(data, size, wanted)) return ONI_STATUS_BAD_PARAMETER;
    return wanted.enabled != FALSE ? ONI_STATUS_NOT_SUPPORTED : ONI_STATUS_OK;
  }
  return ONI_STATUS_NOT_SUPPORTED;
}

OniBool DriverStream::isPropertySupported(int id) {
  switch (id) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
    case ONI_STREAM_PROPERTY_MIRRORING:
    case ONI_STREAM_PROPERTY_CROPPING:
    case ONI_STREAM_PROPERTY_STRIDE: return TRUE;
    case ONI_STREAM_PROPERTY_MAX_VALUE:
    case ONI_STREAM_PROPERTY_MIN_VALUE: return sensor_ == ONI_SENSOR_DEPTH ? TRUE : FALSE;
    default: return FALSE;
  }
}

// The recorder calls this to get the properties that it writes into the file.
void DriverStream::notifyAllProperties() {
  const OniVideoMode now = mode();
  const OniBool mirrored = mirrored_ ? TRUE : FALSE;
  raisePropertyChanged(ONI_STREAM_PROPERTY_VIDEO_MODE, &now, sizeof(now));
  raisePropertyChanged(ONI_STREAM_PROPERTY_HORIZONTAL_FOV, &fov_.x_rad, sizeof(float));
  raisePropertyChanged(ONI_STREAM_PROPERTY_VERTICAL_FOV, &fov_.y_rad, sizeof(float));
  raisePropertyChanged(ONI_STREAM_PROPERTY_MIRRORING, &mirrored, sizeof(mirrored));
  for (const int id : {ONI_STREAM_PROPERTY_MAX_VALUE, ONI_STREAM_PROPERTY_MIN_VALUE}) {
    int value = 0;
    int size = sizeof(value);
    if (getProperty(id, &value, &size) == ONI_STATUS_OK) raisePropertyChanged(id, &value, sizeof(value));
  }
}

OniStatus DriverStream::start() {
  running_ = true;
  return ONI_STATUS_OK;
}

void DriverStream::stop() { running_ = false; }

OniFrame* DriverStream::acquire() {
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) return nullptr;
  const OniVideoMode now = mode();
  frame->sensorType = sensor_;
  frame->videoMode = now;
  frame->width = now.resolutionX;
  frame->height = now.resolutionY;
  frame->stride = now.resolutionX * bytes_per_pixel(now.pixelFormat);
  frame->dataSize = frame->stride * frame->height;
  frame->croppingEnabled = FALSE;
  frame->cropOriginX = 0;
  frame->cropOriginY = 0;
  return frame;
}

void DriverStream::deliver(OniFrame* frame) {
  raiseNewFrame(frame);
  drop(frame);
}

void DriverStream::drop(OniFrame* frame) { getServices().releaseFrame(frame); }

}  // namespace plvo
