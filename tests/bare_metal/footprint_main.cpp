// SPDX-License-Identifier: Apache-2.0
// The smallest program that uses the odometry: its size is what a board pays for the core.
#include "plvo/odometry/odometry.hpp"

namespace {

constexpr plvo::Limits kLimits = plvo::Limits::qvga();
[[gnu::section(".plvo_arena")]] alignas(plvo::kArenaAlignment) std::byte arena[plvo::required_bytes(kLimits)];
plvo::Odometry odometry;

}  // namespace

// Filled and read by nobody that the compiler could see.
plvo::CameraModel camera;
plvo::Config config;
plvo::RgbdFrame frame;
plvo::TrackResult result;

int main() {
  if (!odometry.init(arena, camera, config, kLimits).ok()) return 1;
  for (;;) {
    asm volatile("" ::: "memory");
    result = odometry.track(frame);
  }
}
