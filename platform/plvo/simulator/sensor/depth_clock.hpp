// SPDX-License-Identifier: Apache-2.0
// Exposure time and stamp of the depth image that is paired with a colour image.
#pragma once

#include <cstdint>

#include "plvo/simulator/simulator_options.hpp"

namespace plvo::sim {

class DepthClock {
 public:
  DepthClock(const DepthSchedule& timing, double colour_fps, std::uint64_t seed);

  struct Moment {
    std::int64_t stamp_us = 0;       // as reported, since the start of the sequence
    std::int64_t true_stamp_us = 0;  // without jitter
  };
  // Returns the moment of the depth image nearest to colour image `frame`, which was taken at colour_us.
  Moment nearest(int frame, std::int64_t colour_us) const;

 private:
  DepthSchedule timing_;
  double colour_fps_;
  std::uint32_t seed_;
};

}  // namespace plvo::sim
