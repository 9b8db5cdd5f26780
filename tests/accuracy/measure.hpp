// SPDX-License-Identifier: Apache-2.0
// Tracks a sequence from several starts.
#pragma once

#include <vector>

#include "baseline.hpp"
#include "plvo/odometry/config.hpp"
#include "sequences.hpp"

namespace plvo::accuracy {

// Six starts: the first three frames, each with two principal points a twentieth of a pixel apart. Each has
// its own seed of RANSAC: with the same seed, all six would soon follow the same path.
Status measure(const Sequence& sequence, const Config& config, std::vector<Figures>& starts);

}  // namespace plvo::accuracy
