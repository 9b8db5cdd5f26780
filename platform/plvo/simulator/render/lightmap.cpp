// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/render/lightmap.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "plvo/math/trigonometry.hpp"

namespace plvo::sim {
namespace {

constexpr float kPiF = 3.14159265F;
constexpr std::uint32_t kUnset = 0xffffffffU;
constexpr float kDirectScale = 4096;  // 16 bits hold irradiances up to 16
constexpr float kOpenScale = 65534;   // leaves the all-ones word free for "unset"
constexpr int kPanelEdge = 3;         // 3 × 3 samples on a ceiling panel
constexpr int kRings = 3;             // ambient occlusion: 3 rings of 8 directions
constexpr int kSpokes = 8;
constexpr float kMaxStepCount = 500;

// Cosine-weighted directions over the hemisphere around +z, stratified in rings of equal weight.
std::array<Float3, kRings * kSpokes> hemisphere() {
  std::array<Float3, kRings * kSpokes> directions;
  for (int ring = 0; ring < kRings; ++ring) {
    const double radius = plvo::sqrt((ring + 0.5) / kRings);
    const double height = plvo::sqrt(1 - radius * radius);
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double angle = 2 * kPi * (spoke + ring / 3.0) / kSpokes;
      directions[static_cast<std::size_t>(ring * kSpokes + spoke)] = {static_cast<float>(radius * cos(angle)),
                                                                      static_cast<float>(radius * sin(angle)),
                                                                      static_cast<float>(height)};
    }
  }
  return directions;
}

}  // namespace

float panel_irradiance(const Bvh& bvh, const PanelLight& light, Float3 point, Float3 normal, int per_edge,
                       bool shadows) {
  if (dot(light.normal, point - light.centre) <= 0) return 0;
  const Float3 origin = point + normal * kLift;
  float sum = 0;
  for (int j = 0; j < per_edge; ++j) {
    const float v = (2 * static_cast<float>(j) + 1) / static_cast<float>(per_edge) - 1;
    for (int i = 0; i < per_edge; ++i) {
      const float u = (2 * static_cast<float>(i) + 1) / static_cast<float>(per_edge) - 1;
      const Float3 towards = light.centre + light.half_u * u + light.half_v * v - origin;
      const float square = dot(towards, towards);
      const float facing = dot(towards, normal) * -dot(towards, light.normal);
      if (dot(towards, normal) <= 0 || facing <= 0) continue;
      if (shadows && bvh.occluded({origin, towards}, 0, 0.999F)) continue;
      sum += facing / std::max(square * square, 0.01F);
    }
  }
  return sum * light.power / (kPiF * static_cast<float>(per_edge * per_edge));
}

Lightmap::Lightmap(const Scene& scene) : scene_(scene) {
  std::uint32_t total = 0;
  for (const Solid& solid : scene.solids) {
    for (int face = 0; face < Solid::kFaces; ++face) {
      Grid grid;
      float size_u = 0;
      float size_v = 0;
      face_size(solid, face, size_u, size_v);
      const auto cells = [&](float size) {
        return static_cast<std::uint16_t>(
            std::clamp(std::ceil(size / scene.lightmap_step_m), 1.0F, kMaxStepCount));
      };
      const std::uint16_t cells_u =
          solid.shape == Solid::Shape::kCylinder && face == 0 ? std::uint16_t{12} : cells(size_u);
      const std::uint16_t cells_v = cells(size_v);
      grid.nu = static_cast<std::uint16_t>(cells_u + 1);
      grid.nv = static_cast<std::uint16_t>(cells_v + 1);
      grid.step_u = size_u / static_cast<float>(cells_u);
      grid.step_v = size_v / static_cast<float>(cells_v);
      grid.first = total;
      total += static_cast<std::uint32_t>(grid.nu) * grid.nv;
      grids_.push_back(grid);
    }
  }
  nodes_ = std::make_unique<std::atomic<std::uint32_t>[]>(total);
  for (std::uint32_t i = 0; i < total; ++i) nodes_[i].store(kUnset, std::memory_order_relaxed);
}

std::uint32_t Lightmap::compute(std::size_t surface, std::uint32_t iu, std::uint32_t iv) const {
  const Grid& grid = grids_[surface];
  const Solid& solid = scene_.solids[surface / Solid::kFaces];
  const auto face = static_cast<int>(surface % Solid::kFaces);
  // Nodes on a face's rim lie in the corner between two surfaces; their rays start slightly inside the face
  // instead.
  const auto inset = [](std::uint32_t i, std::uint32_t n, float step) {
    const float margin = std::min(0.04F * step, 0.002F) / step;
    return std::clamp(static_cast<float>(i), margin, static_cast<float>(n - 1) - margin) * step;
  };
  const Float3 local =
      face_point(solid, face, inset(iu, grid.nu, grid.step_u), inset(iv, grid.nv, grid.step_v));
  const Float3 point = solid.to_world(local);
  const Float3 normal = solid.rotate_to_world(face_normal(solid, face, local));

  float direct = 0;
  for (const PanelLight& light : scene_.lights)
    direct += panel_irradiance(scene_.bvh, light, point, normal, kPanelEdge, true);

  static const std::array<Float3, kRings* kSpokes> kDirections = hemisphere();
  const Float3 side =
      normalised(std::abs(normal.z) < 0.9F ? cross(normal, Float3{0, 0, 1}) : cross(normal, Float3{1, 0, 0}));
  const Float3 other = cross(normal, side);
  float open = 0;
  for (const Float3 d : kDirections) {
    const Float3 direction = side * d.x + other * d.y + normal * d.z;
    const Hit hit = scene_.bvh.closest({point + normal * kLift, direction}, 0, scene_.ambient_reach_m);
    // A near surface occludes the room but reflects light itself; its share grows with its distance.
    open += hit.solid < 0 ? 1.0F : 0.2F + 0.8F * hit.t / scene_.ambient_reach_m;
  }
  const auto direct_bits = static_cast<std::uint32_t>(std::min(direct * kDirectScale + 0.5F, 65535.0F));
  const auto open_bits =
      static_cast<std::uint32_t>(open / static_cast<float>(kDirections.size()) * kOpenScale);
  return (direct_bits << 16) | open_bits;
}

Lightmap::Light Lightmap::node(std::size_t surface, std::uint32_t iu, std::uint32_t iv) {
  const Grid& grid = grids_[surface];
  std::atomic<std::uint32_t>& cell = nodes_[grid.first + iv * grid.nu + iu];
  std::uint32_t word = cell.load(std::memory_order_relaxed);
  if (word == kUnset) {
    word = compute(surface, iu, iv);
    cell.store(word, std::memory_order_relaxed);
  }
  return {static_cast<float>(word >> 16) / kDirectScale, static_cast<float>(word & 0xffffU) / kOpenScale};
}

Lightmap::Light Lightmap::at(int solid, int face, float u, float v) {
  const auto surface = static_cast<std::size_t>(solid * Solid::kFaces + face);
  const Grid& grid = grids_[surface];
  const float gu = std::clamp(u / grid.step_u, 0.0F, static_cast<float>(grid.nu - 1) - 1e-3F);
  const float gv = std::clamp(v / grid.step_v, 0.0F, static_cast<float>(grid.nv - 1) - 1e-3F);
  const auto iu = static_cast<std::uint32_t>(gu);
  const auto iv = static_cast<std::uint32_t>(gv);
  const float fu = gu - static_cast<float>(iu);
  const float fv = gv - static_cast<float>(iv);
  const Light a = node(surface, iu, iv);
  const Light b = node(surface, iu + 1, iv);
  const Light c = node(surface, iu, iv + 1);
  const Light d = node(surface, iu + 1, iv + 1);
  return {mix(mix(a.direct, b.direct, fu), mix(c.direct, d.direct, fu), fv),
          mix(mix(a.openness, b.openness, fu), mix(c.openness, d.openness, fu), fv)};
}

}  // namespace plvo::sim
