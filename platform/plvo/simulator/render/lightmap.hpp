// SPDX-License-Identifier: Apache-2.0
// Light that does not change: the direct light of the ceiling panels with their soft shadows, and how open to
// the room a point is (ambient occlusion). Both are computed on a grid over each face, at the moment a
// picture first needs a node, and interpolated in between. Two threads that need the same node compute the
// same value, so whoever stores it last changes nothing.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "plvo/simulator/scene/scene.hpp"

namespace plvo::sim {

constexpr float kLift = 1e-3F;  // m, how far above a surface its rays start

class Lightmap {
 public:
  explicit Lightmap(const Scene& scene);

  struct Light {
    float direct = 0;    // irradiance from the ceiling panels at full power
    float openness = 0;  // 0 … 1
  };
  // At a point of a surface given in face coordinates.
  Light at(int solid, int face, float u, float v);

 private:
  struct Grid {
    std::uint32_t first = 0;
    std::uint16_t nu = 0, nv = 0;
    float step_u = 0, step_v = 0;
  };
  Light node(std::size_t surface, std::uint32_t iu, std::uint32_t iv);
  std::uint32_t compute(std::size_t surface, std::uint32_t iu, std::uint32_t iv) const;

  const Scene& scene_;
  std::vector<Grid> grids_;
  std::unique_ptr<std::atomic<std::uint32_t>[]> nodes_;
};

// Irradiance by a panel at a point with a unit normal, `visible` the share of the panel that is not hidden.
// With shadows == false nothing hides it. `per_edge`² points of the panel are sampled.
float panel_irradiance(const Bvh& bvh, const PanelLight& light, Float3 point, Float3 normal, int per_edge,
                       bool shadows);

}  // namespace plvo::sim
