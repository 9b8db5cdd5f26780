// SPDX-License-Identifier: Apache-2.0
// A core that was built for one kind of features: it refuses the others, and its run is the one that the
// whole core makes when it is asked for that kind alone.
#include "golden_run.hpp"
#include "plvo/bare_metal/semihosting.hpp"

namespace {

[[gnu::section(".plvo_arena")]] alignas(plvo::kArenaAlignment) std::byte arena[plvo::kGoldenArenaBytes];
[[gnu::section(".plvo_frames")]] alignas(plvo::kArenaAlignment) std::byte frames[plvo::kGoldenFrameBytes];
plvo::Odometry odometry;

void print(std::string_view line) {
  plvo::bare_metal::write_text(line);
  plvo::bare_metal::write_text("\n");
}

bool refused(plvo::Features features) {
  plvo::Config config;
  config.features = features;
  return config.validate().code() == plvo::StatusCode::kUnsupported;
}

}  // namespace

int main() {
  const bool no_points = refused(plvo::Features::kPoints);
  if (no_points == refused(plvo::Features::kLines) || !refused(plvo::Features::kBoth)) {
    print("one kind of features should be refused, and both at once");
    return 1;
  }
  return plvo::golden_run({arena, frames, odometry}, print, no_points ? "lines" : "points") ? 0 : 1;
}
