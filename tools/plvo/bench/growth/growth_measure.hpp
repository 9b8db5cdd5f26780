// SPDX-License-Identifier: Apache-2.0
// Measures the cases: the CPU time in this process with interleaved repeats, and the instructions of each
// frame under callgrind.
#pragma once

#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/growth/growth_cases.hpp"
#include "plvo/bench/stages/stage_instructions.hpp"

namespace plvo::bench {

struct GrowthResult {
  std::vector<StageInstructions> frames;  // all but the first, which has no motion
  std::vector<StageTimes> times;          // one for each repeat
};

// Returns one result for each case. Renders the sequences that do not exist yet and prints its progress on
// standard error. Returns kNotFound without valgrind.
Status measure_growth(const GrowthPlan& plan, const GrowthOptions& options,
                      std::vector<GrowthResult>& results);

}  // namespace plvo::bench
