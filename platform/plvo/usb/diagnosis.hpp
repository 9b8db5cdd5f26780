// SPDX-License-Identifier: Apache-2.0
// From facts to findings: everything that usually goes wrong between an RGB-D sensor and its pictures, each
// with what to do about it. A pure function, so that every case is a test. Permissions, 12 V, gspca_kinect,
// USB speed, usbfs memory and the names of OpenNI2's drivers are the known troubles of libfreenect's and
// OpenNI2's users.
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
  std::string remedy;  // what to type or to do; empty where nothing is needed
};

std::vector<Finding> diagnose(const SystemFacts& facts);

// True for a file name that OpenNI2 loads as a driver: lib*.so.0 and nothing else.
bool is_driver_name(const std::string& name);

}  // namespace plvo
