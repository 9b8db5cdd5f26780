// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace plvo {

// Counts of the points, or of the lines, of a frame. If no points were searched in it
// (Window::kRecentFrames), the first three of the points are those of the latest frame in which they
// were.
struct FeatureCounts {
  int detected = 0;    // found, before the selection
  int dropped = 0;     // found, but beyond the capacity
  int with_depth = 0;  // lifted to 3D
  int matched = 0;     // to the reference, putative
  int inliers = 0;     // of the motion
};

}  // namespace plvo
