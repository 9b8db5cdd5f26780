// SPDX-License-Identifier: Apache-2.0
// What a recording contains, and what would be used of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/recording/recording.hpp"

namespace plvo {

struct DescribedTopic {
  std::string name, type;
  std::string encoding;       // of images
  int width = 0, height = 0;  // px, of images
  std::size_t messages = 0;
  double rate_hz = 0;        // 0: unknown
  double longest_gap_s = 0;  // between two messages
  std::string used_as;       // "colour", "depth", "calibration", …; empty: not used
};

struct RecordingDescription {
  std::string format;  // "MCAP"
  std::uintmax_t bytes = 0;
  double duration_s = 0;
  std::vector<DescribedTopic> topics;
  Status opens;            // why it cannot be run, if it cannot
  std::size_t frames = 0;  // pairs of colour and depth; the rest is valid if opens is ok
  std::size_t unpaired_colour = 0;
  Calibration calibration;
  WholeImage whole_image;
  std::vector<std::string> missing;  // "no gyro", …
  std::vector<std::string> remarks;
};

// Returns the errors of a recording that cannot be read at all. One without colour, depth or a calibration is
// described; `opens` says what it lacks. The calibration is that of the recording.
Status describe_recording(const std::filesystem::path& path, const RecordingOptions& options,
                          RecordingDescription& description);

}  // namespace plvo
