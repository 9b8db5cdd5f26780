// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/detectors/line_measures.hpp"

#include <algorithm>
#include <cmath>

namespace plvo::bench {
namespace {

constexpr double kSineOfParallel = 0.0872;  // sin 5°

double cross(const Vector2& u, const Vector2& v) { return u.x() * v.y() - u.y() * v.x(); }

// Coordinates of a point along and across a line, relative to the line's first endpoint.
struct Place {
  double along, across;
};
Place place(const Line& line, const Vector2& direction, const Vector2& p) {
  const Vector2 d = p - line.a;
  return {direction.dot(d), cross(direction, d)};
}

}  // namespace

std::optional<double> offset_if_same(const Line& expected, const Line& found, double tolerance_px) {
  const double length = found.length();
  if (!(length > 0) || !(expected.length() > 0)) return {};
  const Vector2 direction = (found.b - found.a) / length;
  const Place a = place(found, direction, expected.a);
  const Place b = place(found, direction, expected.b);
  const double offset = std::max(std::abs(a.across), std::abs(b.across));
  if (offset > tolerance_px) return {};
  const double covered =
      std::min(std::max(a.along, b.along), length) - std::max(std::min(a.along, b.along), 0.0);
  if (covered < 0.5 * expected.length()) return {};
  return offset;
}

Coverage cover(const Line& edge, const std::vector<Line>& found, double tolerance_px) {
  Coverage coverage;
  const double length = edge.length();
  coverage.samples = static_cast<int>(length) + 1;
  const Vector2 along = length > 0 ? Vector2((edge.b - edge.a) / length) : Vector2(0, 0);
  std::vector<double> nearest(static_cast<std::size_t>(coverage.samples), -1);
  for (const Line& line : found) {
    const double line_length = line.length();
    if (!(line_length > 0)) continue;
    const Vector2 direction = (line.b - line.a) / line_length;
    if (std::abs(cross(along, direction)) > kSineOfParallel) continue;
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      const Place at = place(line, direction, edge.a + static_cast<double>(i) * along);
      const double offset = std::abs(at.across);
      if (offset > tolerance_px || at.along < 0 || at.along > line_length) continue;
      if (nearest[i] < 0 || offset < nearest[i]) nearest[i] = offset;
    }
  }
  for (const double offset : nearest)
    if (offset >= 0) coverage.offsets_px.push_back(offset);
  return coverage;
}

}  // namespace plvo::bench
