// SPDX-License-Identifier: Apache-2.0
// The one call during which callgrind collects. In a file of its own, so that no compiler inlines it.
#pragma once

#include "plvo/odometry/odometry.hpp"

namespace plvo::bench {

// Patterns of callgrind: two, since it takes one option for each.
inline constexpr const char* kCountedFunction = "plvo::bench::track_counted(*";
inline constexpr const char* kFrameEnd =
    "plvo::bench::track_counted(plvo::Odometry&, plvo::RgbdFrame const&)";

// Never inlined, where sources are joined either.
[[gnu::noinline]] TrackResult track_counted(Odometry& odometry, const RgbdFrame& frame);

}  // namespace plvo::bench
