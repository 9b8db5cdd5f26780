// SPDX-License-Identifier: Apache-2.0
// A bounding volume hierarchy over the solids of a room: split by the surface area heuristic (MacDonald &
// Booth, "Heuristics for ray tracing using space subdivision", 1990), swept exactly, since rooms have
// hundreds of solids, not millions.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/simulator/solid.hpp"

namespace plvo::sim {

class Bvh {
 public:
  // Keeps the reference: the solids must live as long as this does and stay where they are.
  void build(const std::vector<Solid>& solids);

  // The nearest hit at t in (t_min, t_max); Hit::solid is −1 when there is none. Among hits at the same t the
  // one that the fixed order of the tree meets first wins.
  Hit closest(const Ray& ray, float t_min, float t_max) const;
  // Is there any hit at t in (t_min, t_max)?
  bool occluded(const Ray& ray, float t_min, float t_max) const;

 private:
  struct Node {
    Float3 lo, hi;
    std::uint32_t first =
        0;  // leaf: index into order_; inner: index of the right child (the left one follows)
    std::uint16_t count = 0;  // leaf: number of solids; inner: 0
    std::uint16_t axis = 0;   // inner: along which the children lie
  };

  std::uint32_t build_node(std::vector<std::uint32_t>& items, std::size_t begin, std::size_t end, int depth);

  const std::vector<Solid>* solids_ = nullptr;
  std::vector<Float3> lo_, hi_;  // bounds of the solids
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

}  // namespace plvo::sim
