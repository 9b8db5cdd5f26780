// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/scene/scene.hpp"

#include "plvo/simulator/hash.hpp"
#include "plvo/simulator/scene/scene_builder.hpp"

namespace plvo::sim {

Hit Scene::closest(const Ray& ray, float t_min, float t_max) const {
  if (first_thing >= solids.size()) return bvh.closest(ray, t_min, t_max);
  Hit best;
  best.t = t_max;
  float t = 0;
  int face = 0;
  if (intersect(things_box_, ray, t_min, t_max, t, face)) {
    for (std::size_t i = first_thing; i < solids.size(); ++i) {
      if (intersect(solids[i], ray, t_min, best.t, t, face)) best = {t, static_cast<int>(i), face};
    }
  }
  const Hit room = bvh.closest(ray, t_min, best.t);
  return room.solid >= 0 ? room : best;
}

bool Scene::occluded(const Ray& ray, float t_min, float t_max) const {
  float t = 0;
  int face = 0;
  for (std::size_t i = first_thing; i < solids.size(); ++i) {
    if (intersect(solids[i], ray, t_min, t_max, t, face)) return true;
  }
  return bvh.occluded(ray, t_min, t_max);
}

void Scene::bound_things() {
  if (first_thing >= solids.size()) return;
  Float3 lo{1e30F, 1e30F, 1e30F};
  Float3 hi{-1e30F, -1e30F, -1e30F};
  for (std::size_t i = first_thing; i < solids.size(); ++i) {
    const Float3 extent = half_extent(solids[i]);
    lo = min3(lo, solids[i].centre - extent);
    hi = max3(hi, solids[i].centre + extent);
  }
  constexpr float kMargin_m = 1e-3F;  // for rounding errors
  things_box_.centre = (lo + hi) * 0.5F;
  things_box_.half = (hi - lo) * 0.5F + Float3{kMargin_m, kMargin_m, kMargin_m};
}

namespace {

std::unique_ptr<Scene> build_room(SceneName name, std::uint64_t seed) {
  switch (name) {
    case SceneName::kCorridor: return build_corridor(seed);
    case SceneName::kStaircase: return build_staircase(seed);
    case SceneName::kHall: return build_hall(seed);
    case SceneName::kDesk: return build_desk(seed);
    case SceneName::kBare: return build_bare(seed);
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<Scene> build_scene(SceneName name, std::uint64_t seed, std::uint32_t storey) {
  std::unique_ptr<Scene> scene = build_room(name, seed);
  if (scene != nullptr && storey != 0)
    for (Solid& solid : scene->solids) solid.seed = hash(solid.seed, storey);
  return scene;
}

}  // namespace plvo::sim
