// SPDX-License-Identifier: Apache-2.0
// Runs all detectors over the views of one sequence.
#pragma once

#include <string>
#include <vector>

#include "plvo/bench/detectors/score.hpp"

namespace plvo::bench {

struct NamedScore {
  std::string detector;
  Score score;
};

struct DetectorComparison {
  std::vector<NamedScore> segments, points;  // ours first
};

DetectorComparison compare_detectors(const ViewSequence& sequence, const DetectorCapacity& capacity,
                                     const ScoreOptions& options);

// Ratio of the CPU time of `score` to that of `ours`: the median over the views of the ratio within a view.
double time_ratio(const Score& score, const Score& ours);

}  // namespace plvo::bench
