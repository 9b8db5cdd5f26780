// SPDX-License-Identifier: Apache-2.0
// Capacities of a map. They determine its memory, and are never exceeded.
#pragma once

#include "plvo/base/status.hpp"

namespace plvo {

struct MapLimits {
  static constexpr int kLeastKeyframes = 8, kMostKeyframes = 512;
  static constexpr int kLeastKeypoints = 50, kMostKeypoints = 400;
  static constexpr int kLeastSegments = 1, kMostSegments = 256;

  int keyframes = 256;
  int keypoints = 200;  // of a keyframe: those that were found first
  int segments = 64;    // of a keyframe, with 3D lines

  // Returns kInvalidArgument, naming the entry and its range.
  Status validate() const;
};

}  // namespace plvo
