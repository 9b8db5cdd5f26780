// SPDX-License-Identifier: Apache-2.0
// Describes a USB device on bus 1 to umockdev.
#pragma once

#include <umockdev.h>

#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace plvo_test {

inline std::string usb_description(const std::string& sysfs, const std::string& node, int address,
                                   const std::vector<std::uint8_t>& descriptors) {
  std::string hex;
  for (const std::uint8_t byte : descriptors) {
    char text[3];
    std::snprintf(text, sizeof(text), "%02X", byte);
    hex += text;
  }
  const std::string number = std::to_string(address);
  return "P: " + sysfs.substr(4) + "\nN: " + node.substr(5) +
         "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: DEVNAME=" + node +
         "\nE: BUSNUM=1\nE: DEVNUM=" + number + "\nA: busnum=1\nA: devnum=" + number +
         "\nA: bConfigurationValue=1\nA: speed=480\nH: descriptors=" + hex + "\n\n";
}

inline void add_to_testbed(UMockdevTestbed* testbed, const std::string& text) {
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed, text.c_str(), &error) == FALSE) {
    throw std::runtime_error(error->message);
  }
}

inline std::string usb_node(int address) {
  char text[32];
  std::snprintf(text, sizeof(text), "/dev/bus/usb/001/%03d", address);
  return text;
}

}  // namespace plvo_test
