// SPDX-License-Identifier: Apache-2.0
// The files of a run that grow line by line. Each is valid at every moment; an output nobody asked for
// takes no line.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "plvo/cli/common/frame_record.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/base_option.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/host/stream/mavlink_stream.hpp"

namespace plvo::cli {

struct OutputOptions {
  std::string trajectory, covariance, motions, stats;
  std::string mavlink;  // address
  BaseOption base;      // what the first three, and pose streams, are about

  // For each: how the user names it, and its path.
  std::vector<std::pair<std::string, std::string>> named() const {
    return {{"--out", trajectory}, {"--covariance", covariance}, {"--motions", motions}, {"--stats", stats}};
  }
  bool has_poses() const {
    return !trajectory.empty() || !covariance.empty() || !motions.empty() || !mavlink.empty();
  }
};
void add_output_options(CLI::App& command, OutputOptions& options);
void check_output_options(const CLI::App& command);

inline constexpr const char* kOutputGroup = "Outputs (a FILE may be -, standard output)";

// Whether one of the paths is standard output, which then carries nothing else.
bool takes_standard_output(const std::vector<std::string>& paths);

class RunOutputs {
 public:
  // Makes the files that were asked for, with their headers.
  Status open(const OutputOptions& options);
  // Poses of frames that have one; a row of statistics for every frame.
  Status write(const FrameRecord& record);

 private:
  TrajectoryFile trajectory_;
  CovarianceFile covariance_;
  MotionFile motions_;
  LineFile stats_;
  MavlinkStream mavlink_;
  BaseOption base_;
};

std::string stats_header();
std::string stats_row(const FrameRecord& record);

}  // namespace plvo::cli
