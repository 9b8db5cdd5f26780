// SPDX-License-Identifier: Apache-2.0
// map_study patrol|recall|carried|soak|cost SCENE LIGHT SEED WIDTH AMOUNT: measures the map in a simulated
// room and prints one JSON object. studies/map.py runs it and writes docs/results/map.md.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "plvo/bench/map/studies.hpp"

namespace {

struct Named {
  std::string_view name;
  void (*run)(const plvo::bench::MapStudy&);
};
constexpr std::array kStudies = {Named{"patrol", plvo::bench::patrol}, Named{"recall", plvo::bench::recall},
                                 Named{"carried", plvo::bench::carried}, Named{"soak", plvo::bench::soak},
                                 Named{"cost", plvo::bench::cost}};

}  // namespace

int main(int count, char** words) {
  plvo::bench::MapStudy study;
  if (count == 7 && plvo::parse_scene(words[2], study.scene).ok() &&
      plvo::parse_light(words[3], study.light).ok()) {
    study.seed = std::strtoull(words[4], nullptr, 10);
    study.width = std::atoi(words[5]);
    study.amount = std::atoi(words[6]);
    for (const Named& named : kStudies) {
      if (named.name != words[1] || study.width <= 0 || study.amount <= 0) continue;
      named.run(study);
      return 0;
    }
  }
  std::fprintf(stderr, "usage: map_study patrol|recall|carried|soak|cost SCENE LIGHT SEED WIDTH AMOUNT\n");
  return 2;
}
