// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/scene/scene_builder.hpp"

#include <cmath>

#include "plvo/math/trigonometry.hpp"

namespace plvo::sim {
namespace {

float cosine(float x) { return static_cast<float>(cos(static_cast<double>(x))); }
float sine(float x) { return static_cast<float>(sin(static_cast<double>(x))); }

}  // namespace

SceneBuilder::SceneBuilder(std::uint64_t seed) : scene_(std::make_unique<Scene>()), random_(seed, 0x5343) {
  panel_material_ =
      material({.pattern = Pattern::kLampPanel, .base = {1, 0.97F, 0.9F}, .infrared = 0.5F, .emission = 4});
  frame_material_ = material({.base = {0.8F, 0.8F, 0.8F}});
}

std::uint16_t SceneBuilder::material(const Material& material) {
  scene_->materials.push_back(material);
  return static_cast<std::uint16_t>(scene_->materials.size() - 1);
}

Solid& SceneBuilder::box(Float3 lo, Float3 hi, std::uint16_t material) {
  Solid solid;
  solid.centre = (lo + hi) * 0.5F;
  solid.half = (hi - lo) * 0.5F;
  solid.material.fill(material);
  solid.seed = random_.next();
  scene_->solids.push_back(solid);
  return scene_->solids.back();
}

Solid& SceneBuilder::turned_box(Float3 centre, Float3 half, float yaw, float tilt, std::uint16_t material) {
  Solid& solid = box(centre - half, centre + half, material);
  solid.aligned = false;
  const float cy = cosine(yaw);
  const float sy = sine(yaw);
  const float ct = cosine(tilt);
  const float st = sine(tilt);
  solid.axes = {Float3{cy * ct, sy * ct, st}, Float3{-sy, cy, 0}, Float3{-cy * st, -sy * st, ct}};
  return solid;
}

Solid& SceneBuilder::cylinder(Float3 centre, float radius, float half_length, std::uint16_t material) {
  const Float3 half{radius, radius, half_length};
  Solid& solid = box(centre - half, centre + half, material);
  solid.shape = Solid::Shape::kCylinder;
  return solid;
}

Solid& SceneBuilder::rod(Float3 a, Float3 b, float radius, std::uint16_t material) {
  Solid& solid = cylinder((a + b) * 0.5F, radius, 0.5F * norm(b - a), material);
  solid.aligned = false;
  solid.axes = axes_along(normalised(b - a));
  return solid;
}

void SceneBuilder::ceiling_panel(float x, float y, float ceiling_z, float half_x, float half_y, float power) {
  constexpr float kRim = 0.02F;
  constexpr float kDeep = 0.05F;
  Solid& panel =
      box({x - half_x, y - half_y, ceiling_z - kDeep}, {x + half_x, y + half_y, ceiling_z}, frame_material_);
  panel.material[4] = panel_material_;  // its underside
  box({x - half_x - kRim, y - half_y - kRim, ceiling_z - 0.03F},
      {x + half_x + kRim, y + half_y + kRim, ceiling_z}, frame_material_);
  scene_->lights.push_back(
      {{x, y, ceiling_z - kDeep - 0.005F}, {half_x, 0, 0}, {0, half_y, 0}, {0, 0, -1}, power});
}

void SceneBuilder::shell(Float3 lo, Float3 hi, std::uint16_t floor, std::uint16_t ceiling,
                         std::uint16_t wall) {
  constexpr float kThick = 0.2F;
  box({lo.x - kThick, lo.y - kThick, lo.z - kThick}, {hi.x + kThick, hi.y + kThick, lo.z}, floor);
  box({lo.x - kThick, lo.y - kThick, hi.z}, {hi.x + kThick, hi.y + kThick, hi.z + kThick}, ceiling);
  box({lo.x - kThick, lo.y, lo.z}, {lo.x, hi.y, hi.z}, wall);
  box({hi.x, lo.y, lo.z}, {hi.x + kThick, hi.y, hi.z}, wall);
  box({lo.x, lo.y - kThick, lo.z}, {hi.x, lo.y, hi.z}, wall);
  box({lo.x, hi.y, lo.z}, {hi.x, hi.y + kThick, hi.z}, wall);
}

Rgb SceneBuilder::colour(float lightness, float saturation) {
  const Rgb hue{uniform(0, 1), uniform(0, 1), uniform(0, 1)};
  const float mean = (hue.x + hue.y + hue.z) / 3 + 1e-3F;
  return mix(Rgb{lightness, lightness, lightness}, hue * (lightness / mean), saturation);
}

std::unique_ptr<Scene> SceneBuilder::finish() {
  scene_->bvh.build(scene_->solids);
  scene_->first_thing = scene_->solids.size();
  return std::move(scene_);
}

}  // namespace plvo::sim
