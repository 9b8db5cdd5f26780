// SPDX-License-Identifier: Apache-2.0
// Time series of a run, for the report's charts.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "plvo/odometry/track_result.hpp"

namespace plvo::report {

struct RunSample {
  std::int64_t stamp_ns = 0;
  std::string state;  // "damaged" for a frame that did not reach the odometry
  float brightness = 0;
  std::array<int, 3> points{}, lines{};         // detected, matched, inliers
  std::array<float, kStageCount + 1> cpu_ms{};  // the last one covers the whole of track()
};

RunSample make_sample(const TrackResult& result, bool damaged, std::int64_t cpu_ns);

}  // namespace plvo::report
