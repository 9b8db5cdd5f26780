// SPDX-License-Identifier: Apache-2.0
// A bare room of 6 × 5 m: white walls, a plain floor with skirting, a door, a window. Only one wall has
// texture (bricks and a few posters). The camera turns from it to the plain walls, where only corners and
// edges are visible, and back.
#include "plvo/simulator/scene/furniture.hpp"

namespace plvo::sim {
namespace {

constexpr float kBareLength = 6;  // x
constexpr float kBareWidth = 5;   // y
constexpr float kBareHeight = 2.7F;

}  // namespace

std::unique_ptr<Scene> build_bare(std::uint64_t seed) {
  SceneBuilder b(seed);
  Furniture f(b);
  const auto white = b.material({.pattern = Pattern::kPlaster,
                                 .base = b.colour(0.7F, 0.08F),
                                 .second = {0.3F, 0.28F, 0.25F},
                                 .contrast = 0.4F,
                                 .infrared = 0.7F});
  const auto plain = b.material({.base = {0.78F, 0.78F, 0.76F}});
  const auto concrete = b.material({.pattern = Pattern::kLinoleum,
                                    .base = b.colour(0.33F, 0.12F),
                                    .second = {0.12F, 0.11F, 0.1F},
                                    .contrast = 0.5F,
                                    .gloss = 0.1F});
  const auto bricks = b.material({.pattern = Pattern::kBricks,
                                  .base = {0.34F, 0.19F, 0.13F},
                                  .second = {0.36F, 0.33F, 0.3F},
                                  .contrast = 1.3F});
  b.shell({0, 0, 0}, {kBareLength, kBareWidth, kBareHeight}, concrete, plain, white);
  const Wall south{{0, 0, 0}, true, 1};
  const Wall north{{0, kBareWidth, 0}, true, -1};
  const Wall west{{0, 0, 0}, false, 1};
  const Wall east{{kBareLength, 0, 0}, false, -1};
  f.skirting(south, kBareLength);
  f.skirting(north, kBareLength);
  f.skirting(west, kBareWidth);
  // The textured wall: a panel of bricks between two white piers.
  f.on_wall(east, {0.6F, kBareWidth - 0.6F}, {0, 0.01F}, {0, kBareHeight}, bricks);
  const int posters = 3 + static_cast<int>(b.uniform(0, 1.99F));
  for (int k = 0; k < posters; ++k) {
    const float slot = (kBareWidth - 1.4F) / static_cast<float>(posters);
    const float width = b.uniform(0.4F, 0.6F);
    f.poster({{kBareLength - 0.01F, 0, 0}, false, -1},
             0.8F + static_cast<float>(k) * slot + b.uniform(0, 0.15F), b.uniform(0.9F, 1.3F), width,
             width * b.uniform(0.75F, 1.4F));
  }
  f.door(north, b.uniform(3.2F, 4.0F), 0.9F, 2.03F);
  f.switches(north, 2.6F);
  f.window(south, {b.uniform(2.9F, 3.3F), 4.6F}, {0.95F, 2.1F});
  // A beam under the ceiling and a boxed pipe in a corner.
  b.box({3.6F, 0, kBareHeight - 0.25F}, {3.85F, kBareWidth, kBareHeight}, white);
  b.box({5.75F, kBareWidth - 0.25F, 0}, {kBareLength, kBareWidth, kBareHeight}, white);
  b.ceiling_panel(2, kBareWidth / 2, kBareHeight, 0.3F, 0.6F, 9);
  b.ceiling_panel(4.9F, kBareWidth / 2, kBareHeight, 0.3F, 0.6F, 9);

  Scene& scene = b.scene();
  scene.ambient = 0.32F;
  scene.free_lo = {0.8F, 0.9F, 0.9F};
  scene.free_hi = {4.4F, 4.1F, 2};
  scene.stroll = {{{1.9F, 2.4F, 1.45F}, 0.5F, -0.1F},  {{2.4F, 2.0F, 1.4F}, 0.9F, -0.14F},
                  {{2.9F, 2.1F, 1.5F}, 1.25F, -0.12F}, {{3.1F, 2.6F, 1.45F}, 0.8F, -0.1F},
                  {{2.9F, 3.1F, 1.5F}, 0.2F, -0.08F},  {{2.5F, 3.2F, 1.45F}, -0.4F, -0.12F},
                  {{2.0F, 2.9F, 1.4F}, 0.0F, -0.1F}};
  return b.finish();
}

}  // namespace plvo::sim
