// SPDX-License-Identifier: Apache-2.0
// Measures the cases: CPU time in this process, repeats interleaved, and the instructions of each frame under
// callgrind.
#pragma once

#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/growth/growth_cases.hpp"
#include "plvo/bench/stages/stage_instructions.hpp"

namespace plvo::bench {

struct GrowthResult {
  std::vector<StageInstructions> frames;  // each but the first, which has no motion
  std::vector<StageTimes> times;          // of each repeat
};

// One for each case. Renders what is not there yet; says on standard error how far it is. kNotFound without
// valgrind.
Status measure_growth(const GrowthPlan& plan, const GrowthOptions& options,
                      std::vector<GrowthResult>& results);

}  // namespace plvo::bench
