// SPDX-License-Identifier: Apache-2.0
// What a detector's features are worth over the views of one sequence.
#pragma once

#include <cstddef>
#include <vector>

#include "plvo/bench/detectors/detector.hpp"
#include "plvo/bench/detectors/view.hpp"

namespace plvo::bench {

struct ScoreOptions {
  double tolerance_px = 2;
  double min_length_px = 20;  // of a segment
  std::size_t gap = 5;        // frames from the one a feature is in to that where it is looked for
};

inline constexpr double kAside_px = 10;

struct Share {
  std::size_t of = 0, held = 0;
  void add(bool holds) {
    ++of;
    held += holds ? 1 : 0;
  }
  double percent() const;  // NaN of nothing
};

struct Score {
  std::vector<double> ms;    // of each view
  std::size_t features = 0;  // of all views
  Share again;               // of the features that the later view could show: found there
  Share again_aside;         // looked for kAside_px beside: how often that is by chance
  std::vector<double> again_px;
  Share recall;  // of the pixels of true edges: covered by a segment
  std::vector<double> recall_px;
  Share precision;        // of the pixels of segments: on an edge of the clean picture
  Share precision_aside;  // of the same, moved kAside_px across
};

// The strongest, most of them first; the longest of those long enough.
std::vector<Vector2> strongest(std::vector<FoundPoint> points, std::size_t most);
std::vector<Line> longest(std::vector<Line> lines, double min_length_px, std::size_t most);

// found: of each view of the sequence.
void score_segments(const ViewSequence& sequence, const std::vector<std::vector<Line>>& found,
                    const ScoreOptions& options, Score& score);
void score_points(const ViewSequence& sequence, const std::vector<std::vector<Vector2>>& found,
                  const ScoreOptions& options, Score& score);

}  // namespace plvo::bench
