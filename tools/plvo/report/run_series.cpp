// SPDX-License-Identifier: Apache-2.0
#include "plvo/report/run_series.hpp"

namespace plvo::report {

RunSample make_sample(const TrackResult& result, bool damaged, std::int64_t cpu_ns) {
  RunSample sample;
  sample.stamp_ns = result.stamp_ns;
  sample.state = damaged ? "damaged" : to_string(result.state);
  sample.brightness = static_cast<float>(result.mean_brightness);
  sample.points = {result.points.detected, result.points.matched, result.points.inliers};
  sample.lines = {result.lines.detected, result.lines.matched, result.lines.inliers};
  for (std::size_t i = 0; i < kStageCount; ++i)
    sample.cpu_ms[i] = static_cast<float>(result.stage_ns[i]) * 1e-6F;
  sample.cpu_ms[kStageCount] = static_cast<float>(cpu_ns) * 1e-6F;
  return sample;
}

}  // namespace plvo::report
