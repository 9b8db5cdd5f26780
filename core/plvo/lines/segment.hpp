// SPDX-License-Identifier: Apache-2.0
// A line segment of the image, as the detector (L1 of the paper) hands it to the descriptor, the matcher and
// the 3D line. Full-resolution pixels; (0, 0) is the centre of the top-left pixel, x right, y down.
#pragma once

#include "plvo/math/types.hpp"

namespace plvo {

// Directed: to one who walks from a to b over the picture as it is looked at, the brighter side is on the
// right, the darker one on the left. The gradient thus points along normal(), and an edge that flips its
// contrast flips its ends.
struct Segment {
  Vector2 a = Vector2::Zero();
  Vector2 b = Vector2::Zero();
  double meaningfulness = 0;   // −log10 of the number of false alarms: ≥ 0, the larger the less by chance
  double sigma_px = 0;         // SD of the line's position across itself, at its middle
  double sigma_angle_rad = 0;  // SD of the line's direction; independent of the one above

  Vector2 middle() const { return 0.5 * (a + b); }
  double length_px() const { return (b - a).norm(); }
  // Unit vectors: along the segment, and across it towards the brighter side.
  Vector2 direction() const { return (b - a) / (b - a).norm(); }
  Vector2 normal() const {
    const Vector2 d = direction();
    return {-d.y(), d.x()};
  }
};

}  // namespace plvo
