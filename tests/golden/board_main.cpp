// SPDX-License-Identifier: Apache-2.0
// The golden run where there is no operating system: every block in a memory of its name, results by
// semihosting.
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

}  // namespace

int main() { return plvo::golden_run({arena, frames, odometry}, print) ? 0 : 1; }
