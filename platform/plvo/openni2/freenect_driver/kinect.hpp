// SPDX-License-Identifier: Apache-2.0
// One Kinect v1 over libfreenect's public C interface. libfreenect is not made for several threads, so
// everything that touches it runs on one thread of the Kinect's own; other threads hand over what they want
// and wait for it. Images come to the listener on that thread.
#pragma once

#include <libfreenect.h>

#include <cstdint>
#include <string>
#include <vector>

#include "plvo/openni2/freenect_driver/command_thread.hpp"

struct libusb_context;

namespace plvo {

// Where a Kinect's camera is plugged in. The same plug gives the same name again: "1-1.3" is bus 1, port 1,
// port 3.
struct KinectPlug {
  std::string port;
  int address = 0;  // changes with each plugging in
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  bool operator==(const KinectPlug&) const = default;
};

// The cameras of all Kinects v1 that the context sees, in the order in which libfreenect counts them.
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

  // Empty when open, otherwise why not, with libusb's name of the error where there is one.
  std::string open(const std::string& port);
  // Depth as the colour camera sees it, from now on or, where it does not run, from its start on.
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
  std::uint64_t ticks_ = 0;  // the newest stamp of either stream, unwrapped

  CommandThread thread_;  // last: it uses all of the above, and closes the device when it ends
};

}  // namespace plvo
