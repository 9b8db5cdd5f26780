// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/scene/scene.hpp"

#include "plvo/simulator/scene/scene_builder.hpp"

namespace plvo::sim {

std::unique_ptr<Scene> build_scene(SceneName name, std::uint64_t seed) {
  switch (name) {
    case SceneName::kCorridor: return build_corridor(seed);
    case SceneName::kStaircase: return build_staircase(seed);
    case SceneName::kHall: return build_hall(seed);
    case SceneName::kDesk: return build_desk(seed);
    case SceneName::kBare: return build_bare(seed);
  }
  return nullptr;
}

}  // namespace plvo::sim
