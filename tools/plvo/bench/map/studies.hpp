// SPDX-License-Identifier: Apache-2.0
// The studies of map_study. Each prints one JSON object.
#pragma once

#include "plvo/simulator/simulator_options.hpp"

namespace plvo::bench {

struct MapStudy {
  SceneName scene = SceneName::kHall;
  LightName light = LightName::kConstant;
  std::uint64_t seed = 21;
  int width = 160;  // px; 4:3
  int amount = 0;   // frames, views or trials
};

// A sequence of `amount` frames: the errors of odometry and map, and of each loop.
void patrol(const MapStudy& study);
// Pairs of a view of the sequence and another one at a distance and an angle: whether LoopCheck accepts them.
// `amount`: views of the sequence.
void recall(const MapStudy& study);
// The camera is put at `amount` places near the mapped trajectory: carried there in the dark, and switched on
// there.
void carried(const MapStudy& study);
// `amount` frames of a closed trajectory, round after round.
void soak(const MapStudy& study);
// The time of a frame with a map of 256 keyframes and without a map, over `amount` frames.
void cost(const MapStudy& study);

}  // namespace plvo::bench
