// SPDX-License-Identifier: Apache-2.0
// Scores the features of a detector over the views of one sequence.
#pragma once

#include <cstddef>
#include <vector>

#include "plvo/bench/detectors/detector.hpp"
#include "plvo/bench/detectors/view.hpp"

namespace plvo::bench {

struct ScoreOptions {
  double tolerance_px = 2;
  double min_length_px = 20;  // of a segment
  std::size_t gap = 5;        // frames between the view of a feature and the view in which it is searched for
};

inline constexpr double kAside_px = 10;

struct Share {
  std::size_t of = 0, held = 0;
  void add(bool holds) {
    ++of;
    held += holds ? 1 : 0;
  }
  double percent() const;  // NaN if the total is 0
};

struct Score {
  std::vector<double> ms;    // of each view
  std::size_t features = 0;  // of all views
  Share again;               // share of the features visible in the later view that are found there
  Share again_aside;         // the same, searched for kAside_px beside: rate of chance matches
  std::vector<double> again_px;
  Share recall;  // share of the pixels of true edges that a segment covers
  std::vector<double> recall_px;
  Share precision;        // share of the pixels of segments that lie on an edge of the noise-free image
  Share precision_aside;  // the same for segments moved by kAside_px across
};

// The `most` strongest points, or the longest of the segments that are long enough.
std::vector<Vector2> strongest(std::vector<FoundPoint> points, std::size_t most);
std::vector<Line> longest(std::vector<Line> lines, double min_length_px, std::size_t most);

// found: the features of each view of the sequence.
void score_segments(const ViewSequence& sequence, const std::vector<std::vector<Line>>& found,
                    const ScoreOptions& options, Score& score);
void score_points(const ViewSequence& sequence, const std::vector<std::vector<Vector2>>& found,
                  const ScoreOptions& options, Score& score);

}  // namespace plvo::bench
