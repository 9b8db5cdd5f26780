// SPDX-License-Identifier: Apache-2.0
// A bounding volume hierarchy over the solids of a room, split by the surface area heuristic (MacDonald &
// Booth, "Heuristics for ray tracing using space subdivision", 1990). The heuristic is evaluated by an exact
// sweep, since rooms have hundreds of solids, not millions.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/simulator/scene/solid.hpp"

namespace plvo::sim {

class Bvh {
 public:
  // Keeps a reference: the solids must outlive this object and must not move.
  void build(const std::vector<Solid>& solids);

  // The nearest hit at t in (t_min, t_max); Hit::solid is −1 if there is none. Among hits at the same t, the
  // first one in the fixed order of the tree is returned.
  Hit closest(const Ray& ray, float t_min, float t_max) const;
  // True if there is any hit at t in (t_min, t_max).
  bool occluded(const Ray& ray, float t_min, float t_max) const;

 private:
  static constexpr int kWidth = 4;
  // A child: an inner node (count 0) or a run of solids in order_.
  struct Child {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  // A SIMD vector of four floats. Each element has the arithmetic of a plain float.
  using Float32x4 = float __attribute__((vector_size(16)));
  struct Node {
    Float32x4 lo[3] = {};
    Float32x4 hi[3] = {};
    Child child[kWidth];
    int size = 0;
  };
  struct BinaryNode {
    Float3 lo, hi;
    std::uint32_t first =
        0;  // leaf: index into order_; inner: index of the right child (the left one follows)
    std::uint32_t count = 0;  // leaf: number of solids; inner: 0
  };

  std::uint32_t build_node(std::vector<std::uint32_t>& items, std::size_t begin, std::size_t end, int depth);
  static void slabs(const Node& node, const Ray& ray, Float3 inverse, float t_min, float t_max,
                    Float32x4& near, Float32x4& far);
  std::uint32_t collapse(std::uint32_t binary_index);

  const std::vector<Solid>* solids_ = nullptr;
  std::vector<Float3> lo_, hi_;  // bounds of the solids
  std::vector<BinaryNode> binary_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

}  // namespace plvo::sim
