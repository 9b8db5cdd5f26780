// SPDX-License-Identifier: Apache-2.0
// Simulated USB devices below the real libusb: umockdev answers for /sys, /dev and the ioctls. The programs
// run under umockdev-wrapper with mock and client in one process, so that the mock can dereference the
// pointers in an ioctl.
#pragma once

#include <umockdev.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace plvo {

struct MockDeviceSpec {
  std::string port;  // "1-1.2"
  int bus = 1;
  int address = 2;
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint16_t bcd = 0x010b;
  const char* speed = "480";
  const char* kernel_driver = nullptr;
};

// Handles transfers. A return value ≥ 0 is the number of bytes moved, < 0 is −errno.
struct MockBehaviour {
  // setup: the 8 bytes of a control transfer; data: the bytes that follow, to read or to fill.
  std::function<int(const std::uint8_t* setup, std::uint8_t* data, int length)> control;
  std::function<int(unsigned endpoint, std::uint8_t* data, int length)> bulk;
  int claim_errno = 0;  // result of claiming an interface, 0 for success
};

class MockUsb {
 public:
  MockUsb();
  ~MockUsb();

  void plug(const MockDeviceSpec& spec, MockBehaviour behaviour = {});
  void unplug(const std::string& port);
  // After this call, the calling thread may not open the device's file (tests often run as root, who has all
  // permissions).
  void deny(const std::string& port);
  void set_usbfs_memory(int megabytes);

 private:
  struct Device;
  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user);

  UMockdevTestbed* testbed_ = nullptr;
  std::map<std::string, std::unique_ptr<Device>> devices_;
};

}  // namespace plvo
