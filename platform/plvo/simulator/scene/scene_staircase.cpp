// SPDX-License-Identifier: Apache-2.0
// A stairwell: a flight of ten steps to a landing, a second flight back above the first, handrails on rods, a
// window over the landing. Its parallel edges have equal spacing and are easily mismatched.
#include <cmath>

#include "plvo/math/trigonometry.hpp"
#include "plvo/simulator/scene/furniture.hpp"

namespace plvo::sim {
namespace {

constexpr float kStaircaseLength = 7.2F;
constexpr float kStaircaseWidth = 2.9F;
constexpr float kStaircaseHeight = 5.6F;
constexpr float kRise = 0.17F;
constexpr float kRun = 0.29F;
constexpr int kStairs = 10;
constexpr float kFoot = 2.6F;     // x of the first riser
constexpr float kFlight = 1.35F;  // width of a flight

void flight(SceneBuilder& b, Furniture& f, float foot_x, float foot_z, float y, float direction,
            std::uint16_t stone) {
  for (int k = 0; k < kStairs; ++k) {
    const float x0 = foot_x + direction * kRun * static_cast<float>(k);
    const float x1 = foot_x + direction * kRun * static_cast<float>(k + 1);
    const float z = foot_z + kRise * static_cast<float>(k + 1);
    const float lo = foot_z > 0 ? z - kRise - 0.12F : 0;  // the upper flight is open underneath
    b.box({std::min(x0, x1), y, lo}, {std::max(x0, x1), y + kFlight, z - 0.03F}, f.plaster);
    // The tread, with its nose and a dark strip along it.
    const float nose = x0 - direction * 0.03F;
    b.box({std::min(nose, x1), y, z - 0.03F}, {std::max(nose, x1), y + kFlight, z}, stone);
    const float strip = x0 + direction * 0.03F;
    b.box({std::min(nose, strip), y + 0.04F, z}, {std::max(nose, strip), y + kFlight - 0.04F, z + 0.003F},
          f.rubber);
  }
}

void handrail(SceneBuilder& b, Furniture& f, float foot_x, float foot_z, float y, float direction) {
  const auto at = [&](float step, float above) {
    return Float3{foot_x + direction * kRun * step, y, foot_z + kRise * (step + 0.5F) + above};
  };
  b.rod(at(0, 0.95F), at(kStairs, 0.95F), 0.024F, f.skirting_wood);
  b.rod(at(0, 0.5F), at(kStairs, 0.5F), 0.01F, f.metal);
  for (int k = 0; k <= kStairs; ++k)
    b.rod(at(static_cast<float>(k), -0.1F), at(static_cast<float>(k), 0.95F), 0.009F, f.frame_paint);
}

}  // namespace

std::unique_ptr<Scene> build_staircase(std::uint64_t seed) {
  SceneBuilder b(seed);
  Furniture f(b);
  const auto tiles = b.material({.pattern = Pattern::kTiles,
                                 .base = b.colour(0.35F, 0.15F),
                                 .second = {0.16F, 0.15F, 0.14F},
                                 .scale = 0.3F,
                                 .gloss = 0.2F});
  const auto stone = b.material({.pattern = Pattern::kLinoleum,
                                 .base = b.colour(0.36F, 0.08F),
                                 .second = {0.1F, 0.1F, 0.1F},
                                 .contrast = 1.5F});
  b.shell({0, 0, 0}, {kStaircaseLength, kStaircaseWidth, kStaircaseHeight}, tiles, f.ceiling, f.plaster);

  const float top_x = kFoot + kRun * kStairs;
  const float top_z = kRise * kStairs;
  const float other_y = kStaircaseWidth - kFlight;
  flight(b, f, kFoot, 0, 0, 1, stone);
  b.box({top_x, 0, top_z - 0.2F}, {kStaircaseLength, kStaircaseWidth, top_z}, stone);  // the landing
  flight(b, f, top_x, top_z, other_y, -1, stone);
  b.box({0, other_y, 2 * top_z - 0.2F}, {kFoot, kStaircaseWidth, 2 * top_z}, stone);
  handrail(b, f, kFoot, 0, kFlight + 0.02F, 1);
  handrail(b, f, top_x, top_z, other_y - 0.02F, -1);
  b.rod({0, other_y + 0.03F, 2 * top_z + 0.95F}, {kFoot, other_y + 0.03F, 2 * top_z + 0.95F}, 0.024F,
        f.skirting_wood);

  const Wall right{{0, 0, 0}, true, 1};
  const Wall left{{0, kStaircaseWidth, 0}, true, -1};
  const Wall end{{kStaircaseLength, 0, 0}, false, -1};
  const Wall begin{{0, 0, 0}, false, 1};
  f.skirting(left, kStaircaseLength);
  f.skirting(begin, kStaircaseWidth);
  f.on_wall(end, {0, kStaircaseWidth}, {0, 0.016F}, {top_z, top_z + 0.1F}, f.skirting_wood);
  f.on_wall(right, {top_x, kStaircaseLength}, {0, 0.016F}, {top_z, top_z + 0.1F}, f.skirting_wood);
  f.on_wall(right, {0, kFoot}, {0, 0.016F}, {0, 0.1F}, f.skirting_wood);
  f.window(end, {0.8F, 2.1F}, {top_z + 1.0F, top_z + 2.3F});
  f.radiator(end, {0.8F, 2.1F});
  f.door(begin, 0.3F, 0.95F, 2.03F);
  f.door(left, 0.6F, 0.9F, 2.03F);
  f.extinguisher(left, 1.9F);
  f.poster(right, 1.0F, 1.2F, 0.5F, 0.7F);
  f.poster(right, kFoot + 0.7F, 1.9F, 0.6F, 0.45F);
  f.poster(right, kFoot + 1.9F, 2.6F, 0.45F, 0.6F);
  f.sign(right, top_x + 0.4F, top_z + 1.5F, 0.3F, 0.3F);
  f.poster(end, 0.15F, top_z + 1.1F, 0.4F, 0.6F);
  f.switches(right, 0.5F);
  b.ceiling_panel(1.4F, 0.7F, kStaircaseHeight, 0.5F, 0.2F, 22);
  b.ceiling_panel(4.2F, 1.4F, kStaircaseHeight, 0.6F, 0.3F, 30);
  b.ceiling_panel(6.3F, 1.4F, kStaircaseHeight, 0.4F, 0.4F, 18);

  Scene& scene = b.scene();
  scene.ambient = 0.35F;
  scene.speed_mps = 0.4F;
  scene.free_lo = {0.6F, 0.4F, 0.9F};
  scene.free_hi = {2.2F, 2.4F, 1.9F};
  // The camera moves up facing the landing, and backwards down again, at a constant height above the steps.
  const auto eye = [&](float x) {
    return 1.5F + kRise * std::min(std::max((x - kFoot) / kRun, 0.0F), static_cast<float>(kStairs));
  };
  scene.stroll = {{{1.5F, 0.75F, eye(1.5F)}, 0.02F, 0.0F},   {{2.3F, 0.7F, eye(2.3F)}, 0.12F, -0.1F},
                  {{3.2F, 0.65F, eye(3.2F)}, 0.2F, -0.2F},   {{4.1F, 0.7F, eye(4.1F)}, 0.05F, -0.25F},
                  {{5.0F, 0.7F, eye(5.0F)}, -0.1F, -0.2F},   {{5.5F, 0.75F, eye(5.5F)}, 0.1F, -0.1F},
                  {{4.6F, 0.75F, eye(4.6F)}, 0.25F, -0.15F}, {{3.5F, 0.75F, eye(3.5F)}, 0.1F, -0.22F},
                  {{2.4F, 0.75F, eye(2.4F)}, -0.1F, -0.12F}};
  return b.finish();
}

}  // namespace plvo::sim
