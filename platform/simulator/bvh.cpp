// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/bvh.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace plvo::sim {
namespace {

constexpr std::size_t kLeafSize = 2;
constexpr int kMaxDepth = 40;  // deeper nodes become leaves, so that the stack of a traversal suffices

Float3 min3(Float3 a, Float3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Float3 max3(Float3 a, Float3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

float half_area(Float3 lo, Float3 hi) {
  const Float3 d = hi - lo;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

// Entry parameter of a ray into a bounding box; false when it misses. The margin covers rounding.
inline bool enters(Float3 lo, Float3 hi, Float3 o, Float3 inverse, float t_min, float t_max, float& entry) {
  const float x0 = (lo.x - o.x) * inverse.x;
  const float x1 = (hi.x - o.x) * inverse.x;
  const float y0 = (lo.y - o.y) * inverse.y;
  const float y1 = (hi.y - o.y) * inverse.y;
  const float z0 = (lo.z - o.z) * inverse.z;
  const float z1 = (hi.z - o.z) * inverse.z;
  const float near =
      std::max(std::max(std::min(x0, x1), std::min(y0, y1)), std::max(std::min(z0, z1), t_min));
  const float far = std::min(std::min(std::max(x0, x1), std::max(y0, y1)), std::min(std::max(z0, z1), t_max));
  entry = near;
  return near <= far * 1.00001F;
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
  nodes_.clear();
  order_.clear();
  std::vector<std::uint32_t> items;
  for (const Solid& solid : solids) {
    Float3 extent;
    const Float3 h = solid.half;
    const auto& a = solid.axes;
    extent.x = std::abs(a[0].x) * h.x + std::abs(a[1].x) * h.y + std::abs(a[2].x) * h.z;
    extent.y = std::abs(a[0].y) * h.x + std::abs(a[1].y) * h.y + std::abs(a[2].y) * h.z;
    extent.z = std::abs(a[0].z) * h.x + std::abs(a[1].z) * h.y + std::abs(a[2].z) * h.z;
    constexpr Float3 kMargin{1e-4F, 1e-4F, 1e-4F};  // rounding, and flat solids
    lo_.push_back(solid.centre - extent - kMargin);
    hi_.push_back(solid.centre + extent + kMargin);
    items.push_back(static_cast<std::uint32_t>(items.size()));
  }
  if (!items.empty()) build_node(items, 0, items.size(), 0);
}

std::uint32_t Bvh::build_node(std::vector<std::uint32_t>& items, std::size_t begin, std::size_t end,
                              int depth) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Float3 lo{1e30F, 1e30F, 1e30F};
  Float3 hi{-1e30F, -1e30F, -1e30F};
  for (std::size_t i = begin; i < end; ++i) {
    lo = min3(lo, lo_[items[i]]);
    hi = max3(hi, hi_[items[i]]);
  }
  nodes_[index].lo = lo;
  nodes_[index].hi = hi;

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
    nodes_[index].first = static_cast<std::uint32_t>(order_.size());
    nodes_[index].count = static_cast<std::uint16_t>(count);
    for (std::size_t i = begin; i < end; ++i) order_.push_back(items[i]);
    return index;
  }
  std::sort(items.begin() + static_cast<std::ptrdiff_t>(begin),
            items.begin() + static_cast<std::ptrdiff_t>(end), by_axis(best_axis));
  build_node(items, begin, begin + best_split, depth + 1);
  const std::uint32_t right = build_node(items, begin + best_split, end, depth + 1);
  nodes_[index].first = right;
  nodes_[index].axis = static_cast<std::uint16_t>(best_axis);
  return index;
}

Hit Bvh::closest(const Ray& ray, float t_min, float t_max) const {
  Hit best;
  best.t = t_max;
  if (nodes_.empty()) return best;
  const Float3 inverse = inverse_direction(ray.direction);
  std::array<std::uint32_t, kMaxDepth + 2> stack{};
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t index = stack[--top];
    const Node& node = nodes_[index];
    float entry = 0;
    if (!enters(node.lo, node.hi, ray.origin, inverse, t_min, best.t, entry)) continue;
    if (node.count == 0) {
      const bool right_first = inverse[node.axis] < 0;
      stack[top++] = right_first ? index + 1 : node.first;
      stack[top++] = right_first ? node.first : index + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const auto item = order_[i];
      float t = 0;
      int face = 0;
      if (intersect((*solids_)[item], ray, t_min, best.t, t, face)) {
        best.t = t;
        best.solid = static_cast<int>(item);
        best.face = face;
      }
    }
  }
  return best;
}

bool Bvh::occluded(const Ray& ray, float t_min, float t_max) const {
  if (nodes_.empty()) return false;
  const Float3 inverse = inverse_direction(ray.direction);
  std::array<std::uint32_t, kMaxDepth + 2> stack{};
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t index = stack[--top];
    const Node& node = nodes_[index];
    float entry = 0;
    if (!enters(node.lo, node.hi, ray.origin, inverse, t_min, t_max, entry)) continue;
    if (node.count == 0) {
      stack[top++] = node.first;
      stack[top++] = index + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      float t = 0;
      int face = 0;
      if (intersect((*solids_)[order_[i]], ray, t_min, t_max, t, face)) return true;
    }
  }
  return false;
}

}  // namespace plvo::sim
