// SPDX-License-Identifier: Apache-2.0
// The golden run of a map where there is an operating system.
#include <cstdio>
#include <memory>
#include <vector>

#include "map_golden_run.hpp"

int main() {
  std::vector<std::byte> arena(plvo::kMapGoldenArenaBytes), map_arena(plvo::kMapGoldenMapBytes);
  std::vector<std::byte> frames(plvo::kMapGoldenFrameBytes), file(plvo::kMapGoldenFileBytes);
  const auto odometry = std::make_unique<plvo::Odometry>();
  const auto map = std::make_unique<plvo::Map>();
  const auto print = [](std::string_view line) {
    std::printf("%.*s\n", static_cast<int>(line.size()), line.data());
  };
  return plvo::map_golden_run({arena, map_arena, frames, file, *odometry, *map}, print) ? 0 : 1;
}
