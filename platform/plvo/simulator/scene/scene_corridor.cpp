// SPDX-License-Identifier: Apache-2.0
// An office corridor, 24 m long and 2.1 m wide: doors with frames on both sides, skirting, a polished floor
// that mirrors the ceiling panels, and little texture in between. It favours line features.
#include <algorithm>

#include "plvo/simulator/scene/furniture.hpp"

namespace plvo::sim {
namespace {

constexpr float kCorridorLength = 24;
constexpr float kCorridorWidth = 2.1F;
constexpr float kCorridorHeight = 2.6F;

// Places doors, and the objects between them, along one wall.
void furnish(SceneBuilder& b, Furniture& f, const Wall& wall, bool left) {
  f.skirting(wall, kCorridorLength);
  float s = b.uniform(0.5F, 1.6F);
  while (s + 1.1F < kCorridorLength) {
    f.door(wall, s, 0.9F, 2.03F);
    s += 1.0F;
    const float gap = b.uniform(1.3F, 2.4F);
    if (b.chance(0.4F)) f.switches(wall, s + 0.5F);
    switch (static_cast<int>(b.uniform(0, 5.99F))) {
      case 0: f.poster(wall, s + 0.55F, b.uniform(1.1F, 1.3F), 0.5F, 0.7F); break;
      case 1: f.extinguisher(wall, s + 0.65F); break;
      case 2: f.sign(wall, s + 0.6F, 1.5F, 0.3F, 0.42F); break;
      case 3: f.radiator(wall, {s + 0.5F, s + 0.4F + std::min(gap - 0.6F, 1.2F)}); break;
      case 4: {
        const Float3 at = wall.origin + Float3{s + 0.75F, wall.outward * 0.24F, 0};
        f.cardboard_box(at, {0.2F, 0.16F, b.uniform(0.12F, 0.2F)}, b.uniform(-0.3F, 0.3F));
        break;
      }
      default: break;
    }
    s += gap;
  }
  // A cable duct under the ceiling, on one side.
  if (left)
    f.on_wall(wall, {0, kCorridorLength}, {0, 0.1F}, {kCorridorHeight - 0.2F, kCorridorHeight - 0.12F},
              f.white);
}

}  // namespace

std::unique_ptr<Scene> build_corridor(std::uint64_t seed) {
  SceneBuilder b(seed);
  Furniture f(b);
  b.shell({0, 0, 0}, {kCorridorLength, kCorridorWidth, kCorridorHeight}, f.floor, f.ceiling, f.plaster);
  furnish(b, f, {{0, 0, 0}, true, 1}, false);
  furnish(b, f, {{0, kCorridorWidth, 0}, true, -1}, true);
  const Wall end{{kCorridorLength, 0, 0}, false, -1};
  f.skirting(end, kCorridorWidth);
  f.window(end, {0.55F, 1.55F}, {0.95F, 2.1F});
  const Wall begin{{0, 0, 0}, false, 1};
  f.skirting(begin, kCorridorWidth);
  f.door(begin, 0.55F, 1.0F, 2.03F);
  for (float x = 1.4F; x < kCorridorLength; x += 3)
    b.ceiling_panel(x, kCorridorWidth / 2, kCorridorHeight, 0.6F, 0.15F, 7);

  Scene& scene = b.scene();
  scene.ambient = 0.3F;
  scene.free_lo = {1.5F, 0.55F, 0.8F};
  scene.free_hi = {21, 1.55F, 1.9F};
  scene.stroll = {{{3.0F, 1.05F, 1.45F}, 0, -0.08F},      {{4.6F, 0.95F, 1.45F}, 0.16F, -0.1F},
                  {{6.4F, 0.85F, 1.45F}, -0.12F, -0.06F}, {{8.0F, 1.0F, 1.45F}, 0.1F, -0.1F},
                  {{9.0F, 1.1F, 1.45F}, 0.22F, -0.08F},   {{8.2F, 1.2F, 1.45F}, -0.1F, -0.05F},
                  {{6.6F, 1.15F, 1.45F}, -0.22F, -0.1F},  {{4.8F, 1.1F, 1.45F}, 0.05F, -0.06F}};
  // The path leads to the far end, makes a half turn, leads back and makes another half turn.
  constexpr float kPi32 = 3.14159265F;
  for (float x = 3; x < 20; x += 1.4F)
    scene.round.push_back({{x, 0.85F, 1.45F}, b.uniform(-0.15F, 0.15F), -0.08F});
  for (int k = 1; k < 4; ++k)
    scene.round.push_back(
        {{20.2F, 0.85F + 0.1F * static_cast<float>(k), 1.45F}, kPi32 * static_cast<float>(k) / 4, -0.06F});
  for (float x = 19.8F; x > 3; x -= 1.4F)
    scene.round.push_back({{x, 1.25F, 1.45F}, kPi32 + b.uniform(-0.15F, 0.15F), -0.08F});
  for (int k = 1; k < 4; ++k)
    scene.round.push_back({{2.6F, 1.25F - 0.1F * static_cast<float>(k), 1.45F},
                           kPi32 * (1 + static_cast<float>(k) / 4),
                           -0.06F});
  return b.finish();
}

}  // namespace plvo::sim
