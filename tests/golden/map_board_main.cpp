// SPDX-License-Identifier: Apache-2.0
// The golden run of a map where there is no operating system: every block in a memory of its name, results by
// semihosting.
#include "map_golden_run.hpp"
#include "plvo/bare_metal/semihosting.hpp"

namespace {

using namespace plvo;

[[gnu::section(".plvo_arena")]] alignas(kArenaAlignment) std::byte arena[kMapGoldenArenaBytes];
[[gnu::section(".plvo_arena")]] alignas(kArenaAlignment) std::byte map_arena[kMapGoldenMapBytes];
[[gnu::section(".plvo_frames")]] alignas(kArenaAlignment) std::byte frames[kMapGoldenFrameBytes];
[[gnu::section(".plvo_frames")]] alignas(kArenaAlignment) std::byte file[kMapGoldenFileBytes];
Odometry odometry;
Map map;

void print(std::string_view line) {
  bare_metal::write_text(line);
  bare_metal::write_text("\n");
}

}  // namespace

int main() { return map_golden_run({arena, map_arena, frames, file, odometry, map}, print) ? 0 : 1; }
