// SPDX-License-Identifier: Apache-2.0
// CPU time of plvo's stages over the frames of a folder, measured in this process.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/job.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo::bench {

// Images that replace those of the folder: the hardest inputs for a detector. Depth is unchanged.
enum class Replacement : std::uint8_t { kRecorded, kNoise, kStripes, kCheckerboard };

struct StageSetting {
  Replacement replacement = Replacement::kRecorded;
  bool tiny = false;                   // Config::tiny(), and those of Limits::tiny() that are not set below
  int keypoints = Limits{}.keypoints;  // capacity
  int segments = Limits{}.segments;
  int surfaces = Limits{}.surfaces;

  void take_limits(const Limits& limits) {
    keypoints = limits.keypoints;
    segments = limits.segments;
    surfaces = limits.surfaces;
  }
  // Same settings as plvo run --preset tiny.
  void make_tiny() {
    tiny = true;
    take_limits(Limits::tiny());
  }
};

struct StageTimes {
  std::array<std::vector<double>, kStageCount> stage_ms;  // of every frame but the first
  std::vector<double> frame_ms;
  std::vector<double> points, segments;  // number kept in each frame
  int lost = 0;
};

// The time excludes decoding. The first frame, which has no motion, is omitted.
Status measure_stages(const NamedFolder& sequence, const JobOptions& options, const StageSetting& setting,
                      StageTimes& times);

}  // namespace plvo::bench
