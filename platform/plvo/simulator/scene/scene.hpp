// SPDX-License-Identifier: Apache-2.0
// A room: its solids and materials, its ceiling lights, and the path of a hand-held camera through it. World
// axes: x and y on the floor, z up, metres. Headings are measured from +x towards +y.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "plvo/simulator/scene/bvh.hpp"
#include "plvo/simulator/scene/material.hpp"
#include "plvo/simulator/scene/solid.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::sim {

// A rectangle that emits light to the side of `normal` by Lambert's law.
struct PanelLight {
  Float3 centre;
  Float3 half_u, half_v;  // half edges
  Float3 normal;
  float power = 10;  // irradiance at distance r straight ahead: power / (π r²)
};

struct PathPoint {
  Float3 position;
  float yaw = 0;    // rad
  float pitch = 0;  // rad, upwards positive
};

struct Scene {
  std::vector<Solid> solids;
  std::vector<Material> materials;
  std::vector<PanelLight> lights;
  Bvh bvh;  // of the room's solids

  // The solids from this index on move between images (things.hpp) and are not in the hierarchy.
  std::size_t first_thing = 0;
  // The same solids where they are when the shutter opens and closes.
  std::vector<Solid> things_opening, things_closing;

  bool is_thing(int solid) const { return static_cast<std::size_t>(solid) >= first_thing; }
  // As Bvh::closest and Bvh::occluded, things included.
  Hit closest(const Ray& ray, float t_min, float t_max) const;
  bool occluded(const Ray& ray, float t_min, float t_max) const;
  // To be called when the things have moved.
  void bound_things();

  float ambient = 0.25F;  // ambient irradiance while the ceiling light is on
  float lightmap_step_m = 0.06F;
  float ambient_reach_m = 1.2F;  // largest distance at which a surface occludes ambient light

  // Control points of two closed paths (uniform cubic B-splines). The heading of the stroll returns without a
  // full turn, and a stroll of short duration is scaled down. The heading of the longer round may make a full
  // turn (empty: no round).
  std::vector<PathPoint> stroll;
  std::vector<PathPoint> round;
  float speed_mps = 0.55F;
  // A recorded trajectory is scaled and shifted until it stays inside this box.
  Float3 free_lo, free_hi;

  const Material& material(int surface) const {
    return materials[solids[static_cast<std::size_t>(surface / Solid::kFaces)]
                         .material[static_cast<std::size_t>(surface % Solid::kFaces)]];
  }

 private:
  Solid things_box_;  // contains all things
};

// Builds the room; the same arguments give the same room (SimulatorOptions). Returns null for an unknown
// name.
std::unique_ptr<Scene> build_scene(SceneName name, std::uint64_t seed, std::uint32_t storey = 0);

}  // namespace plvo::sim
