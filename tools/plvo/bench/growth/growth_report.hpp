// SPDX-License-Identifier: Apache-2.0
// The tables of the growth benchmark, and whether its bounds hold.
#pragma once

#include <string>
#include <vector>

#include "plvo/bench/growth/growth_measure.hpp"

namespace plvo::bench {

// Returns Markdown. results: one for each case of the plan.
std::string growth_report(const GrowthPlan& plan, const std::vector<GrowthResult>& results);

}  // namespace plvo::bench
