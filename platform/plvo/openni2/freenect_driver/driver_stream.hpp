// SPDX-License-Identifier: Apache-2.0
// The driver's side of one OpenNI2 stream: its video modes and the properties that every OpenNI2 client
// reads. A stream must answer the cropping property although it cannot crop; otherwise OpenNI2's recorder
// writes a file that plays no frames. Written from OniDriverAPI.h only.
#pragma once

#include <atomic>
#include <mutex>
#include <span>
#include <vector>

#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

namespace plvo {

struct FieldOfView {
  float x_rad = 0;
  float y_rad = 0;
};

class DriverStream : public oni::driver::StreamBase {
 public:
  // modes: at least one; the first is the default. They must outlive the stream.
  DriverStream(OniSensorType sensor, std::span<const OniVideoMode> modes, FieldOfView fov);

  OniStatus getProperty(int id, void* data, int* size) override;
  OniStatus setProperty(int id, const void* data, int size) override;
  OniBool isPropertySupported(int id) override;
  void notifyAllProperties() override;
  OniStatus start() override;
  void stop() override;

  OniSensorType sensor() const { return sensor_; }
  bool running() const { return running_; }
  OniVideoMode mode() const;
  bool mirrored() const { return mirrored_; }
  static int bytes_per_pixel(OniPixelFormat format);

  // Returns a frame of the stream's mode with all fields but pixels and stamps filled in, or null while
  // OpenNI2 has no free buffer. The frame must be returned with deliver() or drop().
  OniFrame* acquire();
  void deliver(OniFrame* frame);
  void drop(OniFrame* frame);

 protected:
  // Returns true if the driver can mirror images. Otherwise the property is unchanged.
  virtual bool set_mirrored(bool /*mirrored*/) { return false; }
  std::atomic<bool> mirrored_ = false;

 private:
  OniSensorType sensor_;
  std::span<const OniVideoMode> modes_;
  FieldOfView fov_;
  mutable std::mutex mutex_;
  OniVideoMode mode_;
  std::atomic<bool> running_ = false;
};

}  // namespace plvo
