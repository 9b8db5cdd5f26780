// SPDX-License-Identifier: Apache-2.0
// The files of a run that grow line by line. Each is valid at every moment; an output nobody asked for takes
// no line.
#pragma once

#include <string>

#include "plvo/cli/common/frame_record.hpp"
#include "plvo/host/line_file.hpp"
#include "plvo/host/trajectory_file.hpp"

namespace plvo::cli {

struct OutputOptions {
  std::string trajectory, covariance, motions, stats;
};

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
};

std::string stats_header();
std::string stats_row(const FrameRecord& record);

}  // namespace plvo::cli
