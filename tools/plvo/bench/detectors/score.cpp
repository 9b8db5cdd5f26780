// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/detectors/score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace plvo::bench {
namespace {

// Criterion for a point of a segment to lie on an edge of the noise-free image: within one pixel across the
// segment, the grey level changes by at least this much, with the same sign as along most of the segment, and
// across the segment rather than along it.
constexpr double kLeastStep_grey = 5;
constexpr double kTangentOfAcross = 0.41;  // tan 22.5°

// The largest step across the line at one of its points; 0 if there is no edge in the line's direction.
double step_at(const View& view, const Vector2& at, const Vector2& direction) {
  const Vector2 normal(-direction.y(), direction.x());
  double largest = 0;
  for (const int offset : {-1, 0, 1}) {
    const Vector2 beside = at + offset * normal;
    const double across = step_across(view.clean, view.width, view.height, beside, normal);
    const double along = step_across(view.clean, view.width, view.height, beside, direction);
    if (std::abs(across) < kLeastStep_grey || std::abs(along) > kTangentOfAcross * std::abs(across)) continue;
    if (std::abs(across) > std::abs(largest)) largest = across;
  }
  return largest;
}

void score_precision(const View& view, const Line& line, Share& precision) {
  constexpr int kRim_px = 5;  // border in which nothing is compared
  const double length = line.length();
  const Vector2 direction = (line.b - line.a) / length;
  std::size_t samples = 0, brighter = 0, darker = 0;
  for (int i = 0; i <= static_cast<int>(length); ++i) {
    const Vector2 at = line.a + i * direction;
    if (at.x() < kRim_px || at.y() < kRim_px || at.x() > view.width - 1 - kRim_px ||
        at.y() > view.height - 1 - kRim_px)
      continue;
    ++samples;
    const double step = step_at(view, at, direction);
    brighter += step > 0 ? 1 : 0;
    darker += step < 0 ? 1 : 0;
  }
  precision.of += samples;
  precision.held += std::max(brighter, darker);
}

Line moved(const Line& line, double across_px) {
  const Vector2 direction = (line.b - line.a) / line.length();
  const Vector2 across(-direction.y() * across_px, direction.x() * across_px);
  return {line.a + across, line.b + across};
}

// The nearest of the lines that count as `expected`.
std::optional<double> nearest(const Line& expected, const std::vector<Line>& found, double tolerance_px) {
  std::optional<double> best;
  for (const Line& line : found) {
    const std::optional<double> offset = offset_if_same(expected, line, tolerance_px);
    if (offset && (!best || *offset < *best)) best = offset;
  }
  return best;
}

std::optional<double> nearest(const Vector2& expected, const std::vector<Vector2>& found,
                              double tolerance_px) {
  std::optional<double> best;
  for (const Vector2& point : found) {
    const double offset = (point - expected).norm();
    if (offset <= tolerance_px && (!best || offset < *best)) best = offset;
  }
  return best;
}

void count(const std::optional<double>& best, Score& score) {
  score.again.add(best.has_value());
  if (best) score.again_px.push_back(*best);
}

}  // namespace

double Share::percent() const {
  return of == 0 ? std::numeric_limits<double>::quiet_NaN()
                 : 100 * static_cast<double>(held) / static_cast<double>(of);
}

std::vector<Vector2> strongest(std::vector<FoundPoint> points, std::size_t most) {
  std::stable_sort(points.begin(), points.end(),
                   [](const FoundPoint& p, const FoundPoint& q) { return p.strength > q.strength; });
  std::vector<Vector2> kept;
  for (const FoundPoint& point : points)
    if (kept.size() < most) kept.push_back(point.pixel);
  return kept;
}

std::vector<Line> longest(std::vector<Line> lines, double min_length_px, std::size_t most) {
  std::erase_if(lines, [&](const Line& line) { return line.length() < min_length_px; });
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Line& p, const Line& q) { return p.length() > q.length(); });
  if (lines.size() > most) lines.resize(most);
  return lines;
}

void score_segments(const ViewSequence& sequence, const std::vector<std::vector<Line>>& found,
                    const ScoreOptions& options, Score& score) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    const View& view = sequence.views[i];
    score.features += found[i].size();
    if (sequence.truth_known) {
      for (const Line& line : found[i]) {
        score_precision(view, line, score.precision);
        score_precision(view, moved(line, kAside_px), score.precision_aside);
      }
      for (const Line& edge : view.edges) {
        const Coverage coverage = cover(edge, found[i], options.tolerance_px);
        score.recall.of += static_cast<std::size_t>(coverage.samples);
        score.recall.held += coverage.offsets_px.size();
        score.recall_px.insert(score.recall_px.end(), coverage.offsets_px.begin(), coverage.offsets_px.end());
      }
    }
    if (i + options.gap >= found.size()) continue;
    const View& later = sequence.views[i + options.gap];
    for (const Line& line : found[i]) {
      Line carried;
      if (!carry(sequence.pinhole, view, later, line.a, carried.a) ||
          !carry(sequence.pinhole, view, later, line.b, carried.b) ||
          carried.length() < 0.5 * options.min_length_px)
        continue;
      count(nearest(carried, found[i + options.gap], options.tolerance_px), score);
      score.again_aside.add(
          nearest(moved(carried, kAside_px), found[i + options.gap], options.tolerance_px).has_value());
    }
  }
}

void score_points(const ViewSequence& sequence, const std::vector<std::vector<Vector2>>& found,
                  const ScoreOptions& options, Score& score) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    score.features += found[i].size();
    if (i + options.gap >= found.size()) continue;
    for (const Vector2& point : found[i]) {
      Vector2 carried = Vector2::Zero();
      if (!carry(sequence.pinhole, sequence.views[i], sequence.views[i + options.gap], point, carried))
        continue;
      count(nearest(carried, found[i + options.gap], options.tolerance_px), score);
      const Vector2 aside = carried + Vector2(i % 2 == 0 ? kAside_px : -kAside_px, 0);
      score.again_aside.add(nearest(aside, found[i + options.gap], options.tolerance_px).has_value());
    }
  }
}

}  // namespace plvo::bench
