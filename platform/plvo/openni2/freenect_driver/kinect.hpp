// SPDX-License-Identifier: Apache-2.0
// One Kinect v1, accessed through libfreenect's public C interface. libfreenect is not thread-safe, so all
// calls of it run on one dedicated thread. Other threads pass their commands to it and wait for the results.
// The listener receives images on that thread.
#pragma once

#include <libfreenect.h>

#include <cstdint>
#include <string>
#include <vector>

#include "plvo/openni2/freenect_driver/command_thread.hpp"

struct libusb_context;

namespace plvo {

// The USB port of a Kinect's camera. The name depends only on the port: "1-1.3" is bus 1, port 1, port 3.
struct KinectPlug {
  std::string port;
  int address = 0;  // changes each time it is plugged in
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  bool operator==(const KinectPlug&) const = default;
};

// The cameras of all Kinects v1 in the context, in libfreenect's order.
std::vector<KinectPlug> list_kinects(libusb_context* usb);

class KinectListener {
 public:
  virtual ~KinectListener() = default;
  virtual void on_depth(const std::uint16_t* depth_mm, std::uint64_t stamp_us) = 0;
  virtual void on_colour(const std::uint8_t* rgb, std::uint64_t stamp_us) = 0;
};

class Kinect {
 public:
  static constexpr int kWidth = 640;
  static constexpr int kHeight = 480;

  explicit Kinect(KinectListener& listener);
  Kinect(const Kinect&) = delete;
  Kinect& operator=(const Kinect&) = delete;

  // Returns an empty string on success, otherwise the reason of the failure, with libusb's error name if
  // there is one.
  std::string open(const std::string& port);
  // Registers depth to the colour camera, from now on or, if depth is not running, from its start on.
  bool set_registered(bool registered);
  bool start_depth();
  bool start_colour();
  void stop_depth();
  void stop_colour();

 private:
  bool process_events();
  bool start_depth_here();
  std::string open_here(const std::string& port);
  void close_here();
  std::uint64_t to_us(std::uint32_t ticks);

  KinectListener& listener_;
  libusb_context* usb_ = nullptr;
  freenect_context* freenect_ = nullptr;
  freenect_device* device_ = nullptr;
  bool registered_ = false;
  bool depth_runs_ = false;
  bool colour_runs_ = false;
  std::uint64_t ticks_ = 0;  // newest stamp of either stream, unwrapped

  CommandThread thread_;  // last member: uses all members above, and closes the device when it ends
};

}  // namespace plvo
