// SPDX-License-Identifier: Apache-2.0
// Capacities of a map. They determine its memory, and are never exceeded.
#pragma once

#include "plvo/base/status.hpp"

namespace plvo {

struct MapLimits {
  static constexpr int kMostKeyframes = 512;

  int keyframes = 256;  // 8 … kMostKeyframes
  int keypoints = 200;  // of a keyframe, 50 … 400: those that were found first
  int segments = 64;    // with 3D lines, of a keyframe, 1 … 256

  // Returns kInvalidArgument, naming the entry and its range.
  Status validate() const;
};

}  // namespace plvo
