// SPDX-License-Identifier: Apache-2.0
// What the machine looks like to somebody who wants a picture from an RGB-D sensor: plain data, gathered once
// by gather_facts(), judged by diagnose(). Nothing in here is an opinion.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plvo/usb/known_sensors.hpp"

namespace plvo {

class UsbBus;

enum class UsbAccess : std::uint8_t {
  kNotTried,
  kFree,    // opened, and its first interface claimed and given back
  kDenied,  // the device file may not be opened by this user
  kBusy,    // another process (or a kernel driver that does not let go) holds the interface
  kGone,    // it went away while it was looked at
  kFailed,  // anything else
};

struct UsbDeviceFacts {
  KnownUsbDevice known;
  std::uint16_t bcd = 0;
  int bus = 0;
  int address = 0;
  std::string port;           // "1-1.2": bus, then the ports down the tree of hubs
  std::string node;           // "/dev/bus/usb/001/004"
  int speed_mbps = 0;         // 0: the system does not say
  std::string kernel_driver;  // bound to the first interface; empty: none
  UsbAccess access = UsbAccess::kNotTried;
  std::string access_error;  // libusb's own word for kFailed
};

struct DriverFileFacts {
  std::string name;
  std::string load_error;  // empty: it loads
};

struct OpenniFacts {
  bool built_in = true;   // this plvo was built with OpenNI2
  bool found = false;     // libOpenNI2.so.0 loads
  std::string error;      // why not
  std::string directory;  // where it looks for its drivers
  bool directory_exists = false;
  std::vector<DriverFileFacts> files;
};

struct SystemFacts {
  bool usb_works = true;
  std::string usb_error;
  bool hot_plug = true;
  std::vector<UsbDeviceFacts> devices;  // known sensors only, ordered by bus and port
  long usbfs_memory_mb = -1;            // −1: the system does not say; 0: no limit
  std::string udev_rule;                // path of the installed rule file; empty: not installed
  OpenniFacts openni;
};

struct GatherOptions {
  bool try_access = true;       // opens every known device for a moment
  bool openni_built_in = true;  // whether this program can use OpenNI2 at all
  std::string openni_library = "libOpenNI2.so.0";
};

SystemFacts gather_facts(UsbBus& bus, const GatherOptions& options = {});

// Where the loaded libOpenNI2 looks for drivers: beside the path it was loaded from, or what the ini file
// says.
OpenniFacts gather_openni(const std::string& library);

}  // namespace plvo
