// SPDX-License-Identifier: Apache-2.0
// A room: its solids and materials, the lights at its ceiling, and the walk that somebody with a camera in
// the hand would take through it. World axes: x and y on the floor, z up, metres; headings are counted from
// +x towards +y.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "plvo/simulator/scene/bvh.hpp"
#include "plvo/simulator/scene/material.hpp"
#include "plvo/simulator/scene/solid.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::sim {

// A rectangle that shines to the side of `normal`, by Lambert's law.
struct PanelLight {
  Float3 centre;
  Float3 half_u, half_v;  // half edges
  Float3 normal;
  float power = 10;  // irradiance at distance r straight ahead: power / (π r²)
};

struct WalkPoint {
  Float3 position;
  float yaw = 0;    // rad
  float pitch = 0;  // rad, upwards positive
};

struct Scene {
  std::vector<Solid> solids;
  std::vector<Material> materials;
  std::vector<PanelLight> lights;
  Bvh bvh;

  float ambient = 0.25F;  // irradiance from everywhere while the ceiling light is on
  float lightmap_step_m = 0.06F;
  float ambient_reach_m = 1.2F;  // how far away a surface still darkens a corner

  // Control points of two closed walks (uniform cubic B-splines): a stroll, whose heading returns without a
  // full turn and which shrinks when time is short, and a long round, whose heading may wind around (empty:
  // no round).
  std::vector<WalkPoint> stroll;
  std::vector<WalkPoint> round;
  float speed_mps = 0.55F;
  // A recorded trajectory is scaled and shifted until it stays inside this box.
  Float3 free_lo, free_hi;

  const Material& material(int surface) const {
    return materials[solids[static_cast<std::size_t>(surface / Solid::kFaces)]
                         .material[static_cast<std::size_t>(surface % Solid::kFaces)]];
  }
};

// Builds the room; the same name and seed give the same room. Null for a room that this version does not
// have.
std::unique_ptr<Scene> build_scene(SceneName name, std::uint64_t seed);

}  // namespace plvo::sim
