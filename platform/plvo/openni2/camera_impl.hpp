// SPDX-License-Identifier: Apache-2.0
// Implementation of OpenNi2Camera. Internal to this module.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "plvo/openni2/frame_pairer.hpp"
#include "plvo/openni2/image_device.hpp"
#include "plvo/openni2/openni2_camera.hpp"
#include "plvo/openni2/openni2_device.hpp"
#include "plvo/openni2/software_registration.hpp"
#include "plvo/openni2/stamp_tracker.hpp"

namespace plvo {

class OpenNi2Recorder;

struct OpenNi2Camera::Impl {
  Status open();
  Status open_device();
  Status choose_model(const StreamFormat& colour);
  Status next(RgbdFrame& frame);
  Status take(const DeviceImage& image);
  void count_dropped(FramePairer::Stream stream, int index);
  void deliver(const FramePairer::Pair& pair, RgbdFrame& frame);
  Status timeout();
  Status lose();
  bool find_again(std::string& uri) const;
  Status replug(std::chrono::steady_clock::time_point deadline);
  void log(LogLevel level, const Status& status) const;

  OpenNi2Options options;
  std::shared_ptr<OpenNi2Runtime> runtime;  // null for a recording, which another process reads
  std::unique_ptr<ImageDevice> device;      // null while unplugged
  OpenNi2Device* sensor = nullptr;          // the device, if it is opened in this process
  OpenNi2DeviceInfo info;
  CameraModel model;
  FramePairer pairer;
  StampTracker tracker;
  SoftwareRegistration registration;
  std::vector<std::uint16_t> registered;
  OpenNi2Recorder* recorder = nullptr;

  OpenNi2Counters counters;
  std::int64_t period_us = 33333;
  std::int64_t last_delivered_us = 0;
  double metres_per_unit = 0.001;
  bool registered_by_device = true;
  bool warp = false;
  bool unplugged = false;
  bool after_gap = false;  // frames lost while the device is unplugged do not count as missing
  std::array<int, 2> last_index = {-1, -1};
  std::array<bool, 2> seen_in_call{};
};

}  // namespace plvo
