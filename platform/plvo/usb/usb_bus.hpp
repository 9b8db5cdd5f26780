// SPDX-License-Identifier: Apache-2.0
// The USB as plvo needs it: which known sensors are there, and a word when one arrives or leaves.
// libusb 1.0. OpenNI2 over libfreenect raises no event when a Kinect is unplugged, it merely times out: this
// tells.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/usb/facts.hpp"

struct libusb_context;
struct libusb_device;

namespace plvo {

struct UsbEvent {
  enum class Kind : std::uint8_t { kArrived, kLeft } kind = Kind::kArrived;
  KnownUsbDevice known;
  std::string port;
};

class UsbBus {
 public:
  UsbBus();
  ~UsbBus();
  UsbBus(const UsbBus&) = delete;
  UsbBus& operator=(const UsbBus&) = delete;

  // Must come first; kIo with libusb's own word when there is no USB to talk to (a container, a missing
  // kernel module).
  Status open();

  // The known sensors that are plugged in now. Opens nothing.
  std::vector<UsbDeviceFacts> list() const;

  // True if a camera of a known sensor is plugged in.
  bool camera_present() const;

  // From here on arrivals and departures are collected. kUnsupported where the platform has no hot-plug
  // events; then list() again from time to time.
  Status watch();

  // Waits up to timeout_ms for events of known devices; returns those that came since the last call.
  std::vector<UsbEvent> poll(int timeout_ms);

  libusb_context* context() const { return context_; }

 private:
  struct Watch;
  libusb_context* context_ = nullptr;
  std::unique_ptr<Watch> watch_;
};

// "1-1.2", the name that the kernel gives the port.
std::string port_name(libusb_device* device);

}  // namespace plvo
