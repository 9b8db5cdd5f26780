// SPDX-License-Identifier: Apache-2.0
// The doctor's practical part: a sensor is opened and watched for some seconds, and what is wrong with what
// comes is put in words. Judging is a pure function, so that every case is a test.
#pragma once

#include <string>
#include <vector>

#include "plvo/cli/live/live_camera.hpp"
#include "plvo/usb/diagnosis.hpp"

namespace plvo::cli {

struct CaptureFacts {
  bool tried = false;
  Status opened;  // not ok: the sensor could not even be opened
  Status last;    // of the last call of next()
  std::string name;
  VideoMode mode;
  double seconds = 0;
  bool registered_by_device = false;
  bool depth_time_known = false;      // the calibration in force says when depth is exposed
  std::vector<std::string> warnings;  // what the camera said itself
  double mean_brightness = 0;         // of the last colour image, 0 … 255
  double depth_share = 0;             // of the last depth image's pixels, those with depth
  OpenNi2Counters counters;

  double hz() const { return seconds > 0 ? static_cast<double>(counters.frames) / seconds : 0; }
  double megabytes_per_s() const;  // of colour and depth, as they come to this program
};

// Watches the sensor for about `seconds`, the first frame not counted.
CaptureFacts capture(const LiveCameraOptions& options, double seconds);

struct CaptureFinding {
  Severity severity = Severity::kGood;
  std::string code;  // for machines
  std::string what, remedy;
};
std::vector<CaptureFinding> judge(const CaptureFacts& facts);

}  // namespace plvo::cli
