// SPDX-License-Identifier: Apache-2.0
// Instructions of plvo's stages and of their steps, from a profile of callgrind.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/bench/stages/callgrind_costs.hpp"
#include "plvo/bench/table.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo::bench {

// One row for each step, as the mean over `frames` frames.
Table instructions_table(const CallgrindCosts& costs, std::size_t frames);

// `all` minus the sum over the stages is the cost outside of the stages.
struct StageInstructions {
  std::array<std::uint64_t, kStageCount> stage{};
  std::uint64_t all = 0;
};
StageInstructions stage_instructions(const CallgrindCosts& costs);

}  // namespace plvo::bench
