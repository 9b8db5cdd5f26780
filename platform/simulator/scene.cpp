// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/scene.hpp"

#include "plvo/simulator/scene_builder.hpp"

namespace plvo::sim {

std::unique_ptr<Scene> build_scene(SceneName name, std::uint64_t seed) {
  switch (name) {
    case SceneName::kBare: return build_bare(seed);
    default: return nullptr;
  }
}

}  // namespace plvo::sim
