// SPDX-License-Identifier: Apache-2.0
// The state of the machine that is relevant for RGB-D sensors: plain data, gathered once by gather_facts()
// and judged by diagnose().
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plvo/usb/known_sensors.hpp"

namespace plvo {

class UsbBus;

enum class UsbAccess : std::uint8_t {
  kNotTried,
  kFree,    // was opened, and its first interface was claimed and released
  kDenied,  // this user may not open the device file
  kBusy,    // another process (or a kernel driver that does not release it) holds the interface
  kGone,    // it was removed during the check
  kFailed,  // any other error
};

struct UsbDeviceFacts {
  KnownUsbDevice known;
  std::uint16_t bcd = 0;
  int bus = 0;
  int address = 0;
  std::string port;           // "1-1.2": bus, then the ports along the tree of hubs
  std::string node;           // "/dev/bus/usb/001/004"
  int speed_mbps = 0;         // 0: unknown
  std::string kernel_driver;  // bound to the first interface; empty: none
  UsbAccess access = UsbAccess::kNotTried;
  std::string access_error;  // libusb's error name for kFailed
};

struct DriverFileFacts {
  std::string name;
  std::string load_error;  // empty: it can be loaded
};

struct OpenniFacts {
  bool built_in = true;   // plvo was built with OpenNI2
  bool found = false;     // libOpenNI2.so.0 can be loaded
  std::string error;      // the reason if it cannot
  std::string directory;  // folder in which it looks for its drivers
  bool directory_exists = false;
  std::vector<DriverFileFacts> files;
};

struct SystemFacts {
  bool usb_works = true;
  std::string usb_error;
  bool hot_plug = true;
  std::vector<UsbDeviceFacts> devices;  // known sensors only, ordered by bus and port
  long usbfs_memory_mb = -1;            // −1: unknown; 0: no limit
  std::string udev_rule;                // path of the installed rule file; empty: not installed
  OpenniFacts openni;
};

struct GatherOptions {
  bool try_access = true;       // opens every known device briefly
  bool openni_built_in = true;  // whether this program can use OpenNI2 at all
  std::string openni_library = "libOpenNI2.so.0";
};

SystemFacts gather_facts(UsbBus& bus, const GatherOptions& options = {});

// Facts about OpenNI2. The loaded libOpenNI2 looks for drivers beside the path it was loaded from, or in the
// folder set in the ini file.
OpenniFacts gather_openni(const std::string& library);

}  // namespace plvo
