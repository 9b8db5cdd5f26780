// SPDX-License-Identifier: Apache-2.0
// Decides when a segment counts as found: as the same segment in another frame, and as a known true edge.
#pragma once

#include <optional>
#include <vector>

#include "plvo/math/types.hpp"

namespace plvo::bench {

struct Line {
  Vector2 a = Vector2::Zero(), b = Vector2::Zero();  // px
  double length() const { return (b - a).norm(); }
};

// Distance across `found` from the farther endpoint of `expected`, in pixels, if the two are the same line:
// both endpoints of `expected` lie within tolerance_px across it, and `found` covers at least half of the
// length of `expected`. Otherwise returns nullopt. The direction of a segment does not count.
std::optional<double> offset_if_same(const Line& expected, const Line& found, double tolerance_px);

// Samples the edge at steps of one pixel and collects the samples that lie within tolerance_px of a found
// segment that is parallel to within 5°.
struct Coverage {
  int samples = 0;
  std::vector<double> offsets_px;  // of each covered sample, to the nearest such segment
};
Coverage cover(const Line& edge, const std::vector<Line>& found, double tolerance_px);

}  // namespace plvo::bench
