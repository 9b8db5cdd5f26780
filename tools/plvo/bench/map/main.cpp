// SPDX-License-Identifier: Apache-2.0
// map_study STUDY SCENE LIGHT SEED WIDTH AMOUNT: measures the map in a simulated room and prints one JSON
// object. studies/map.py runs it and writes docs/results/map.md.
#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "plvo/bench/map/studies.hpp"

int main(int argc, char** argv) {
  using plvo::bench::MapStudy;
  const std::map<std::string, void (*)(const MapStudy&)> studies = {{"patrol", plvo::bench::patrol},
                                                                    {"recall", plvo::bench::recall},
                                                                    {"carried", plvo::bench::carried},
                                                                    {"soak", plvo::bench::soak},
                                                                    {"cost", plvo::bench::cost}};
  CLI::App app("What a map does in a simulated room", "map_study");
  MapStudy study;
  std::string name, scene, light;
  app.add_option("study", name, "What is measured")->required()->check(CLI::IsMember(studies));
  app.add_option("scene", scene, "Scene of the simulator")->required();
  app.add_option("light", light, "Light of the simulator")->required();
  app.add_option("seed", study.seed, "Of the room, the trajectory and the noise")->required();
  app.add_option("width", study.width, "Of the images; the height is 3/4 of it")
      ->required()
      ->check(CLI::Range(plvo::Limits::kLeastSide, plvo::Limits::kMostSide));
  app.add_option("amount", study.amount, "Frames, views or trials")->required()->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  for (const plvo::Status& status :
       {plvo::parse_scene(scene, study.scene), plvo::parse_light(light, study.light)}) {
    if (status.ok()) continue;
    std::fprintf(stderr, "map_study: %s\n", status.message());
    return 2;
  }
  studies.at(name)(study);
  return 0;
}
