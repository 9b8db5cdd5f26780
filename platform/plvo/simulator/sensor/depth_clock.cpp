// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/sensor/depth_clock.hpp"

#include <cmath>

#include "plvo/simulator/hash.hpp"

namespace plvo::sim {

DepthClock::DepthClock(const DepthSchedule& timing, double colour_fps, std::uint64_t seed)
    : timing_(timing), colour_fps_(colour_fps), seed_(sensor_seed(seed, 0x54U)) {}

DepthClock::Moment DepthClock::nearest(int frame, std::int64_t colour_us) const {
  Moment moment;
  moment.true_stamp_us = colour_us + std::llround(timing_.stamp_offset_s * 1e6);
  if (timing_.fps && *timing_.fps != colour_fps_) {
    const double image = std::floor((frame / colour_fps_ - timing_.stamp_offset_s) * *timing_.fps + 0.5);
    moment.true_stamp_us = std::llround((timing_.stamp_offset_s + image / *timing_.fps) * 1e6);
  }
  const float noise = gaussian(hash(static_cast<std::uint32_t>(frame), seed_));
  moment.stamp_us =
      moment.true_stamp_us + std::llround(timing_.stamp_jitter_s * static_cast<double>(noise) * 1e6);
  return moment;
}

}  // namespace plvo::sim
