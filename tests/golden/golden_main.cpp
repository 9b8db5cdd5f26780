// SPDX-License-Identifier: Apache-2.0
// The golden run where there is an operating system.
#include <cstdio>
#include <vector>

#include "golden_run.hpp"

int main() {
  std::vector<std::byte> arena(plvo::kGoldenArenaBytes), frames(plvo::kGoldenFrameBytes);
  plvo::Odometry odometry;
  const auto print = [](std::string_view line) {
    std::printf("%.*s\n", static_cast<int>(line.size()), line.data());
  };
  return plvo::golden_run({arena, frames, odometry}, print) ? 0 : 1;
}
