// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/hard_cases.hpp"

namespace plvo {

std::vector<HardCase> hard_cases() {
  constexpr double kDuration_s = 3.3;
  std::vector<HardCase> cases;
  const auto add = [&](const char* name, double fps, auto change) {
    HardCase hard{name, {}};
    hard.options.fps = fps;
    hard.options.frames = static_cast<int>(kDuration_s * fps + 0.5) + 1;
    change(hard.options);
    cases.push_back(hard);
  };
  add("board_still", 30, [](SimulatorOptions& o) {
    o.difficulties.board.emplace();
    o.still = true;
  });
  add("board_walks", 30, [](SimulatorOptions& o) { o.difficulties.board.emplace(); });
  add("person_crosses", 30, [](SimulatorOptions& o) { o.difficulties.person.emplace(); });
  add("bumper", 30, [](SimulatorOptions& o) { o.difficulties.bumper_share = 0.15; });
  add("dots", 30, [](SimulatorOptions& o) { o.difficulties.dots = 4500; });
  add("mirror", 30, [](SimulatorOptions& o) { o.difficulties.mirror = true; });
  add("comb", 30, [](SimulatorOptions& o) { o.difficulties.comb = true; });
  add("frozen_depth", 30, [](SimulatorOptions& o) { o.difficulties.frozen_depth = 20; });
  add("repeated_frames", 60, [](SimulatorOptions& o) { o.difficulties.repeated_frames = true; });
  add("five_hz", 5, [](SimulatorOptions&) {});
  return cases;
}

}  // namespace plvo
