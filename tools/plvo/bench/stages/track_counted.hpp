// SPDX-License-Identifier: Apache-2.0
// The call during which callgrind collects. It has its own source file, so that no compiler inlines it.
#pragma once

#include "plvo/odometry/odometry.hpp"

namespace plvo::bench {

// Patterns for callgrind. There are two because its two options take different ones.
inline constexpr const char* kCountedFunction = "plvo::bench::track_counted(*";
inline constexpr const char* kFrameEnd =
    "plvo::bench::track_counted(plvo::Odometry&, plvo::RgbdFrame const&)";

// noinline also holds in unity builds.
[[gnu::noinline]] TrackResult track_counted(Odometry& odometry, const RgbdFrame& frame);

}  // namespace plvo::bench
