// SPDX-License-Identifier: Apache-2.0
// One OpenNI2 device with its colour and depth streams. They are opened in an order that all known drivers
// support: the depth stream is created before registration is requested, since libfreenect's driver crashes
// otherwise. Internal to this module; the only header here that includes OpenNI.h.
#pragma once

#include <OpenNI.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "plvo/base/status.hpp"
#include "plvo/openni2/image_device.hpp"

namespace plvo {

// OpenNI2 is initialised while an object of this class exists. Several may exist.
class OpenNi2Runtime {
 public:
  ~OpenNi2Runtime();
  OpenNi2Runtime(const OpenNi2Runtime&) = delete;
  OpenNi2Runtime& operator=(const OpenNi2Runtime&) = delete;
  static Status acquire(std::shared_ptr<OpenNi2Runtime>& runtime);

 private:
  OpenNi2Runtime() = default;
};

class OpenNi2Device final : public ImageDevice,
                            private openni::OpenNI::DeviceDisconnectedListener,
                            private openni::OpenNI::DeviceStateChangedListener {
 public:
  explicit OpenNi2Device(std::shared_ptr<OpenNi2Runtime> runtime);
  ~OpenNi2Device() override;

  Status open(const std::string& uri, const OpenNi2Options& options);
  Status start() override;
  void close();

  Wait wait(int timeout_ms, DeviceImage& image) override;
  // Used by the recorder.
  openni::VideoStream& colour() { return colour_; }
  openni::VideoStream& depth() { return depth_; }
  const StreamFormat& colour_format() const override { return colour_format_; }
  const StreamFormat& depth_format() const override { return depth_format_; }
  const OpenNi2DeviceInfo& info() const override { return info_; }
  bool is_file() const override { return is_file_; }
  bool registered() const override { return registered_; }
  bool gone() const override { return gone_; }
  bool at_end() const override { return at_end_; }
  int recorded_frames() override;

 private:
  void onDeviceDisconnected(const openni::DeviceInfo* info) override;
  void onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) override;
  Status create_stream(openni::VideoStream& stream, openni::SensorType sensor, const OpenNi2Options& options,
                       StreamFormat& format);
  void set_registration(const OpenNi2Options& options);

  std::shared_ptr<OpenNi2Runtime> runtime_;
  openni::Device device_;
  openni::VideoStream colour_;
  openni::VideoStream depth_;
  openni::VideoFrameRef lent_;
  StreamFormat colour_format_;
  StreamFormat depth_format_;
  OpenNi2DeviceInfo info_;  // written in open() under mutex_, because the listeners read it on other threads
  std::mutex mutex_;
  bool is_file_ = false;
  bool registered_ = false;
  bool listening_ = false;
  std::atomic<bool> gone_ = false;
  std::atomic<bool> at_end_ = false;
};

}  // namespace plvo
