// SPDX-License-Identifier: Apache-2.0
// A line segment of the image: the output of the detector (L1 of the paper) and the input of the descriptor,
// the matcher and the 3D line fit. Full-resolution pixels; (0, 0) is the centre of the top-left pixel, x
// right, y down.
#pragma once

#include "plvo/math/types.hpp"

namespace plvo {

// A directed segment: in the displayed image, seen from a towards b, the brighter side is on the right and
// the darker side on the left. The gradient points along normal(). If an edge inverts its contrast, its ends
// swap.
struct Segment {
  Vector2 a = Vector2::Zero();
  Vector2 b = Vector2::Zero();
  double meaningfulness = 0;  // −log10 of the number of false alarms, ≥ 0; larger means less likely by chance
  double sigma_px = 0;        // SD of the position across the segment, at its middle
  double sigma_angle_rad = 0;  // SD of the direction; independent of sigma_px

  Vector2 middle() const { return 0.5 * (a + b); }
  double length_px() const { return (b - a).norm(); }
  // Unit vectors along the segment, and across it towards the brighter side.
  Vector2 direction() const { return (b - a) / (b - a).norm(); }
  Vector2 normal() const {
    const Vector2 d = direction();
    return {-d.y(), d.x()};
  }
};

}  // namespace plvo
