// SPDX-License-Identifier: Apache-2.0
// Static light: the direct light of the ceiling panels with soft shadows, and the openness of each point to
// the room (ambient occlusion). Both are computed on a grid over each face, when an image first needs a node,
// and interpolated in between. Two threads that need the same node compute the same value, so the order in
// which they store it does not matter.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "plvo/simulator/scene/scene.hpp"

namespace plvo::sim {

constexpr float kLift = 1e-3F;  // m, height above a surface at which its rays start

class Lightmap {
 public:
  explicit Lightmap(const Scene& scene);

  struct Light {
    float direct = 0;    // irradiance from the ceiling panels at full power
    float openness = 0;  // 0 … 1
  };
  // Light at a point of a surface, given in face coordinates.
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

// Irradiance from a panel at a point with a unit normal, sampled at `per_edge`² points of the panel. With
// shadows == false, occlusion is ignored.
float panel_irradiance(const Bvh& bvh, const PanelLight& light, Float3 point, Float3 normal, int per_edge,
                       bool shadows);

}  // namespace plvo::sim
