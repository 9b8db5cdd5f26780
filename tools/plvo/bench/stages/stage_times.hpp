// SPDX-License-Identifier: Apache-2.0
// CPU time of plvo's stages over the frames of a folder, in this process.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/job.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo::bench {

// What the camera sees instead of the folder's images, for the frames that are hardest on a detector. Depth
// stays as it is.
enum class Replacement : std::uint8_t { kRecorded, kNoise, kStripes, kCheckerboard };

struct StageSetting {
  Replacement replacement = Replacement::kRecorded;
  bool tiny = false;                   // Config::tiny(), and what of Limits::tiny() is not below
  int keypoints = Limits{}.keypoints;  // room for so many
  int segments = Limits{}.segments;
  int surfaces = Limits{}.surfaces;

  void take_limits(const Limits& limits) {
    keypoints = limits.keypoints;
    segments = limits.segments;
    surfaces = limits.surfaces;
  }
  // As plvo run --preset tiny.
  void make_tiny() {
    tiny = true;
    take_limits(Limits::tiny());
  }
};

struct StageTimes {
  std::array<std::vector<double>, kStageCount> stage_ms;  // of each frame but the first
  std::vector<double> frame_ms;
  std::vector<double> points, segments;  // of each frame, those kept
  int lost = 0;
};

// Decoding is outside of the timed part. The first frame, which has no motion, is left out.
Status measure_stages(const NamedFolder& sequence, const JobOptions& options, const StageSetting& setting,
                      StageTimes& times);

}  // namespace plvo::bench
