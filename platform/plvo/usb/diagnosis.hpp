// SPDX-License-Identifier: Apache-2.0
// Derives findings from facts: the usual problems with RGB-D sensors, each with a remedy. It is a pure
// function, so every case has a test. Permissions, 12 V, gspca_kinect, USB speed, usbfs memory and the names
// of OpenNI2's drivers are the known problems of libfreenect's and OpenNI2's users.
#pragma once

#include <string>
#include <vector>

#include "plvo/usb/facts.hpp"

namespace plvo {

enum class FindingCode : std::uint8_t {
  kReady,
  kUsbUnavailable,
  kNothingPluggedIn,
  kTwelveVolts,
  kPermission,
  kBusy,
  kKernelDriver,
  kSlowPort,
  kSharedBus,
  kUsbfsMemory,
  kGone,
  kAccessFailed,
  kRuleMissing,
  kNoHotPlug,
  kOpenniNotBuilt,
  kOpenniMissing,
  kDriverFolderMissing,
  kDriverMissing,
  kDriverMisnamed,
  kDriverBroken,
};
const char* to_string(FindingCode code);

enum class Severity : std::uint8_t { kGood, kNote, kProblem };

struct Finding {
  Severity severity = Severity::kGood;
  FindingCode code = FindingCode::kReady;
  std::string what;    // one or two sentences
  std::string remedy;  // command to type or action to take; empty if none is needed
};

std::vector<Finding> diagnose(const SystemFacts& facts);

// True for a file name that OpenNI2 loads as a driver: only lib*.so.0.
bool is_driver_name(const std::string& name);

}  // namespace plvo
