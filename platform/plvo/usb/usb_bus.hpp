// SPDX-License-Identifier: Apache-2.0
// Lists the known sensors on the USB and reports when one is plugged in or unplugged, by libusb 1.0. It is
// needed because OpenNI2 over libfreenect raises no event when a Kinect is unplugged; it only times out.
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

  // Must be called first. Returns kIo with libusb's error name if USB is not accessible (in a container, or
  // without the kernel module).
  Status open();

  // The known sensors that are currently plugged in. Opens no device.
  std::vector<UsbDeviceFacts> list() const;

  // True if a camera of a known sensor is plugged in.
  bool camera_present() const;

  // Starts to collect hot-plug events. Returns kUnsupported if the platform has none; then poll list()
  // instead.
  Status watch();

  // Waits up to timeout_ms for events of known devices; returns the events since the last call.
  std::vector<UsbEvent> poll(int timeout_ms);

  libusb_context* context() const { return context_; }

 private:
  struct Watch;
  libusb_context* context_ = nullptr;
  std::unique_ptr<Watch> watch_;
};

// The kernel's name of the port, e.g. "1-1.2".
std::string port_name(libusb_device* device);

}  // namespace plvo
