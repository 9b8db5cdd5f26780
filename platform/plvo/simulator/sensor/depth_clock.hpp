// SPDX-License-Identifier: Apache-2.0
// When the depth image that goes with a colour image was exposed, and the stamp that it bears.
#pragma once

#include <cstdint>

#include "plvo/simulator/simulator_options.hpp"

namespace plvo::sim {

class DepthClock {
 public:
  DepthClock(const DepthSchedule& timing, double colour_fps, std::uint64_t seed);

  struct Moment {
    std::int64_t stamp_us = 0;       // as reported, since the walk began
    std::int64_t true_stamp_us = 0;  // without its jitter
  };
  // Of the depth image nearest to colour image `frame`, which was taken at colour_us.
  Moment nearest(int frame, std::int64_t colour_us) const;

 private:
  DepthSchedule timing_;
  double colour_fps_;
  std::uint32_t seed_;
};

}  // namespace plvo::sim
