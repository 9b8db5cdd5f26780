// SPDX-License-Identifier: Apache-2.0
// When a segment counts as found: again in another frame, and as an edge that is known to be there.
#pragma once

#include <optional>
#include <vector>

#include "plvo/math/types.hpp"

namespace plvo::bench {

struct Line {
  Vector2 a = Vector2::Zero(), b = Vector2::Zero();  // px
  double length() const { return (b - a).norm(); }
};

// How far, in pixels across it, `found` is from `expected` (the farther end of `expected`), where it is the
// same line: both ends of `expected` are within tolerance_px across it, and it covers at least half of the
// length of `expected`. Nothing else; directions do not count.
std::optional<double> offset_if_same(const Line& expected, const Line& found, double tolerance_px);

// Of the edge's length, in samples a pixel apart: how many of them lie within tolerance_px of a found segment
// that is parallel to within 5°.
struct Coverage {
  int samples = 0;
  std::vector<double> offsets_px;  // of each that is covered, to the nearest such segment
};
Coverage cover(const Line& edge, const std::vector<Line>& found, double tolerance_px);

}  // namespace plvo::bench
