// SPDX-License-Identifier: Apache-2.0
// What the doctor has seen and thinks, as one page of text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "plvo/cli/doctor/doctor_capture.hpp"

namespace plvo::cli {

struct DoctorReport {
  SystemFacts system;
  std::vector<OpenNi2DeviceInfo> openni_devices;
  std::vector<Finding> findings;  // diagnose(system)
  CaptureFacts capture;
  std::vector<CaptureFinding> capture_findings;

  // A sensor gave good pictures; or, where no capture was asked for, nothing was found to be wrong.
  bool healthy() const;
};

std::string to_text(const DoctorReport& report);
nlohmann::ordered_json to_json(const DoctorReport& report);

}  // namespace plvo::cli
