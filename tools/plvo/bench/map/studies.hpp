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

// A walk of `amount` frames: the errors of odometry and map, each loop compared with the truth.
void patrol(const MapStudy& study);
// Pairs of a view of the walk and another one at a distance and an angle: whether LoopCheck accepts them.
// `amount`: views of the sequence.
void recall(const MapStudy& study);
// `amount` times the camera is put to a place near the mapped walk: carried there in the dark, and switched
// on there.
void carried(const MapStudy& study);
// `amount` frames of a closed walk, round and round.
void soak(const MapStudy& study);
// The time of a frame with a map of 256 keyframes and without, over `amount` frames.
void cost(const MapStudy& study);

}  // namespace plvo::bench
