// SPDX-License-Identifier: Apache-2.0
// Instructions of plvo's stages and of the steps in them, out of a profile of callgrind.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/bench/stages/callgrind_costs.hpp"
#include "plvo/bench/table.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo::bench {

// Each step's, of the mean of so many frames.
Table instructions_table(const CallgrindCosts& costs, std::size_t frames);

// What no stage accounts for is the rest of `all`.
struct StageInstructions {
  std::array<std::uint64_t, kStageCount> stage{};
  std::uint64_t all = 0;
};
StageInstructions stage_instructions(const CallgrindCosts& costs);

}  // namespace plvo::bench
