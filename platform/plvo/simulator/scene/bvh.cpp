// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/scene/bvh.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace plvo::sim {
namespace {

constexpr std::size_t kLeafSize = 2;
constexpr int kMaxDepth = 40;  // deeper nodes become leaves, which bounds the stack of a traversal

float half_area(Float3 lo, Float3 hi) {
  const Float3 d = hi - lo;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

Float3 inverse_direction(Float3 d) {
  const auto inverse = [](float x) { return 1.0F / (x > 0 ? std::max(x, 1e-12F) : std::min(x, -1e-12F)); };
  return {inverse(d.x), inverse(d.y), inverse(d.z)};
}

}  // namespace

void Bvh::build(const std::vector<Solid>& solids) {
  solids_ = &solids;
  lo_.clear();
  hi_.clear();
  binary_.clear();
  nodes_.clear();
  order_.clear();
  std::vector<std::uint32_t> items;
  for (const Solid& solid : solids) {
    const Float3 extent = half_extent(solid);
    constexpr Float3 kMargin{1e-4F, 1e-4F, 1e-4F};  // for rounding errors and flat solids
    lo_.push_back(solid.centre - extent - kMargin);
    hi_.push_back(solid.centre + extent + kMargin);
    items.push_back(static_cast<std::uint32_t>(items.size()));
  }
  if (items.empty()) return;
  build_node(items, 0, items.size(), 0);
  collapse(0);
}

std::uint32_t Bvh::build_node(std::vector<std::uint32_t>& items, std::size_t begin, std::size_t end,
                              int depth) {
  const auto index = static_cast<std::uint32_t>(binary_.size());
  binary_.emplace_back();
  Float3 lo{1e30F, 1e30F, 1e30F};
  Float3 hi{-1e30F, -1e30F, -1e30F};
  for (std::size_t i = begin; i < end; ++i) {
    lo = min3(lo, lo_[items[i]]);
    hi = max3(hi, hi_[items[i]]);
  }
  binary_[index].lo = lo;
  binary_[index].hi = hi;

  const std::size_t count = end - begin;
  const auto by_axis = [this](int axis) {
    return [this, axis](std::uint32_t a, std::uint32_t b) {
      const float ca = lo_[a][axis] + hi_[a][axis];
      const float cb = lo_[b][axis] + hi_[b][axis];
      return ca != cb ? ca < cb : a < b;
    };
  };
  float best_cost = 1e30F;
  int best_axis = -1;
  std::size_t best_split = 0;
  if (count > kLeafSize && depth < kMaxDepth) {
    std::vector<float> left_area(count);
    for (int axis = 0; axis < 3; ++axis) {
      std::sort(items.begin() + static_cast<std::ptrdiff_t>(begin),
                items.begin() + static_cast<std::ptrdiff_t>(end), by_axis(axis));
      Float3 a = lo_[items[begin]];
      Float3 b = hi_[items[begin]];
      for (std::size_t i = 0; i < count; ++i) {
        a = min3(a, lo_[items[begin + i]]);
        b = max3(b, hi_[items[begin + i]]);
        left_area[i] = half_area(a, b);
      }
      a = lo_[items[end - 1]];
      b = hi_[items[end - 1]];
      for (std::size_t i = count - 1; i > 0; --i) {
        a = min3(a, lo_[items[begin + i]]);
        b = max3(b, hi_[items[begin + i]]);
        const float cost =
            left_area[i - 1] * static_cast<float>(i) + half_area(a, b) * static_cast<float>(count - i);
        if (cost < best_cost) {
          best_cost = cost;
          best_axis = axis;
          best_split = i;
        }
      }
    }
  }
  if (best_axis < 0) {
    binary_[index].first = static_cast<std::uint32_t>(order_.size());
    binary_[index].count = static_cast<std::uint32_t>(count);
    for (std::size_t i = begin; i < end; ++i) order_.push_back(items[i]);
    return index;
  }
  std::sort(items.begin() + static_cast<std::ptrdiff_t>(begin),
            items.begin() + static_cast<std::ptrdiff_t>(end), by_axis(best_axis));
  build_node(items, begin, begin + best_split, depth + 1);
  const std::uint32_t right = build_node(items, begin + best_split, end, depth + 1);
  binary_[index].first = right;
  return index;
}

// Collapses a binary node to a node of up to four children: replaces the child of the largest surface by its
// children until there are four.
std::uint32_t Bvh::collapse(std::uint32_t binary_index) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  std::array<std::uint32_t, kWidth> open{binary_index};
  int size = 1;
  while (size < kWidth) {
    int largest = -1;
    for (int k = 0; k < size; ++k) {
      const BinaryNode& candidate = binary_[open[static_cast<std::size_t>(k)]];
      if (candidate.count != 0) continue;
      const auto area = [&](int i) {
        const BinaryNode& node = binary_[open[static_cast<std::size_t>(i)]];
        return half_area(node.lo, node.hi);
      };
      if (largest < 0 || area(k) > area(largest)) largest = k;
    }
    if (largest < 0) break;
    const std::uint32_t parent = open[static_cast<std::size_t>(largest)];
    open[static_cast<std::size_t>(largest)] = parent + 1;
    open[static_cast<std::size_t>(size++)] = binary_[parent].first;
  }
  for (int k = 0; k < size; ++k) {
    const BinaryNode& child = binary_[open[static_cast<std::size_t>(k)]];
    const Child link = child.count != 0 ? Child{child.first, child.count}
                                        : Child{collapse(open[static_cast<std::size_t>(k)]), 0};
    Node& node = nodes_[index];
    for (int axis = 0; axis < 3; ++axis) {
      node.lo[axis][k] = child.lo[axis];
      node.hi[axis][k] = child.hi[axis];
    }
    node.child[k] = link;
  }
  nodes_[index].size = size;
  return index;
}

// Ray parameters at the entry and exit of four boxes, computed in SIMD (slab method of Kay & Kajiya).
inline void Bvh::slabs(const Node& node, const Ray& ray, Float3 inverse, float t_min, float t_max,
                       Float32x4& near, Float32x4& far) {
  near = Float32x4{t_min, t_min, t_min, t_min};
  far = Float32x4{t_max, t_max, t_max, t_max};
  for (int axis = 0; axis < 3; ++axis) {
    const float o = ray.origin[axis];
    const float s = inverse[axis];
    const Float32x4 enter = ((s < 0 ? node.hi[axis] : node.lo[axis]) - o) * s;
    const Float32x4 leave = ((s < 0 ? node.lo[axis] : node.hi[axis]) - o) * s;
    near = enter > near ? enter : near;
    far = leave < far ? leave : far;
  }
}

namespace {

constexpr float kRounding = 1.00001F;  // makes boxes slightly too long, never too short

}  // namespace

Hit Bvh::closest(const Ray& ray, float t_min, float t_max) const {
  struct Entry {
    Child child;
    float near;
  };
  Hit best;
  best.t = t_max;
  if (nodes_.empty()) return best;
  const Float3 inverse = inverse_direction(ray.direction);
  std::array<Entry, 3 * kMaxDepth + 4> stack;
  std::size_t top = 0;
  stack[top++] = {{0, 0}, t_min};
  while (top > 0) {
    const Entry entry = stack[--top];
    if (entry.near > best.t * kRounding) continue;
    if (entry.child.count != 0) {
      for (std::uint32_t i = entry.child.first; i < entry.child.first + entry.child.count; ++i) {
        float t = 0;
        int face = 0;
        if (intersect((*solids_)[order_[i]], ray, t_min, best.t, t, face))
          best = {t, static_cast<int>(order_[i]), face};
      }
      continue;
    }
    const Node& node = nodes_[entry.child.first];
    Float32x4 near;
    Float32x4 far;
    slabs(node, ray, inverse, t_min, best.t, near, far);
    // The nearest child is pushed last, so it is visited first.
    const std::size_t base = top;
    for (int k = 0; k < node.size; ++k) {
      if (near[k] > far[k] * kRounding) continue;
      std::size_t at = top++;
      for (; at > base && stack[at - 1].near < near[k]; --at) stack[at] = stack[at - 1];
      stack[at] = {node.child[k], near[k]};
    }
  }
  return best;
}

bool Bvh::occluded(const Ray& ray, float t_min, float t_max) const {
  if (nodes_.empty()) return false;
  const Float3 inverse = inverse_direction(ray.direction);
  std::array<std::uint32_t, 3 * kMaxDepth + 4> stack;
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    Float32x4 near;
    Float32x4 far;
    slabs(node, ray, inverse, t_min, t_max, near, far);
    for (int k = 0; k < node.size; ++k) {
      if (near[k] > far[k] * kRounding) continue;
      const Child child = node.child[k];
      if (child.count == 0) {
        stack[top++] = child.first;
        continue;
      }
      for (std::uint32_t i = child.first; i < child.first + child.count; ++i) {
        float t = 0;
        int face = 0;
        if (intersect((*solids_)[order_[i]], ray, t_min, t_max, t, face)) return true;
      }
    }
  }
  return false;
}

}  // namespace plvo::sim
