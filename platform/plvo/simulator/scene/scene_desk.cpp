// SPDX-License-Identifier: Apache-2.0
// An office with a full desk: monitors, keyboard, books, papers and mugs within two metres, with shelves and
// a whiteboard behind them. It has texture everywhere and depth steps at every object, and so favours point
// features.
#include "plvo/simulator/scene/furniture.hpp"

namespace plvo::sim {
namespace {

constexpr float kDeskLength = 5;
constexpr float kDeskWidth = 4.2F;
constexpr float kDeskHeight = 2.6F;
constexpr float kTop = 0.74F;  // height of the desk

void desk_top(SceneBuilder& b, Furniture& f) {
  const auto keys = b.material({.pattern = Pattern::kKeyboard,
                                .base = {0.03F, 0.03F, 0.03F},
                                .second = {0.11F, 0.11F, 0.11F},
                                .infrared = 0.25F});
  f.table({3.3F, 1.0F, 0}, {4.15F, 3.1F, kTop});
  f.monitor({3.95F, 1.65F, kTop}, 3.14159F + b.uniform(-0.15F, 0.35F), 0.55F);
  f.monitor({3.95F, 2.35F, kTop}, 3.14159F + b.uniform(-0.35F, 0.15F), 0.5F);
  b.turned_box({3.5F, 2.0F, kTop + 0.012F}, {0.075F, 0.22F, 0.012F}, b.uniform(-0.12F, 0.12F), 0, keys);
  b.turned_box({3.48F, 2.35F, kTop + 0.015F}, {0.055F, 0.03F, 0.015F}, b.uniform(-0.3F, 0.3F), 0, f.black);
  f.mug({3.55F, 1.5F + b.uniform(-0.08F, 0.08F), kTop});
  f.mug({3.75F, 2.8F, kTop});
  f.books_lying({3.6F, 1.2F, kTop}, b.uniform(-0.4F, 0.4F), 3 + static_cast<int>(b.uniform(0, 2.9F)));
  f.books_lying({3.95F, 2.9F, kTop}, b.uniform(-0.4F, 0.4F), 4);
  for (int k = 0; k < 6; ++k)
    f.paper({b.uniform(3.42F, 3.65F), 1.75F + 0.22F * static_cast<float>(k) + b.uniform(-0.06F, 0.06F),
             kTop + 0.0005F * static_cast<float>(k)},
            b.uniform(-0.7F, 0.7F));
  // Pens, a cable, a pencil pot.
  for (int k = 0; k < 5; ++k) {
    const Float3 at{b.uniform(3.4F, 3.8F), b.uniform(1.3F, 2.9F), kTop + 0.006F};
    b.rod(at, at + Float3{b.uniform(-0.1F, 0.1F), b.uniform(-0.1F, 0.1F), 0}, 0.004F,
          k % 2 == 0 ? f.red : f.black);
  }
  const Float3 pot{3.85F, 2.02F, kTop};
  b.cylinder(pot + Float3{0, 0, 0.05F}, 0.035F, 0.05F, f.metal);
  for (int k = 0; k < 4; ++k)
    b.rod(pot + Float3{0, 0, 0.05F}, pot + Float3{b.uniform(-0.04F, 0.04F), b.uniform(-0.04F, 0.04F), 0.17F},
          0.004F, k % 2 == 0 ? f.furniture_wood : f.red);
}

}  // namespace

std::unique_ptr<Scene> build_desk(std::uint64_t seed) {
  SceneBuilder b(seed);
  Furniture f(b);
  const auto carpet = b.material({.pattern = Pattern::kCarpet,
                                  .base = b.colour(0.16F, 0.4F),
                                  .second = b.colour(0.09F, 0.3F),
                                  .infrared = 0.45F});
  b.shell({0, 0, 0}, {kDeskLength, kDeskWidth, kDeskHeight}, carpet, f.ceiling, f.plaster);
  const Wall south{{0, 0, 0}, true, 1};
  const Wall north{{0, kDeskWidth, 0}, true, -1};
  const Wall west{{0, 0, 0}, false, 1};
  const Wall east{{kDeskLength, 0, 0}, false, -1};
  f.skirting(south, kDeskLength);
  f.skirting(north, kDeskLength);
  f.skirting(west, kDeskWidth);
  f.skirting(east, kDeskWidth);
  desk_top(b, f);
  f.chair({2.75F, 2.6F, 0}, b.uniform(-0.6F, 0.2F), 0.46F);
  f.chair({1.2F, 0.8F, 0}, b.uniform(0.3F, 1.0F), 0.46F);
  f.bin({4.4F, 0.7F, 0});
  f.cardboard_box({4.5F, 3.7F, 0}, {0.22F, 0.18F, 0.16F}, 0.4F);

  f.shelf({kDeskLength, 0.15F, 0}, {kDeskLength - 0.28F, 1.35F, 2.0F}, false, -1, 5);
  f.shelf({kDeskLength, 3.0F, 0.0F}, {kDeskLength - 0.28F, 4.0F, 1.6F}, false, -1, 4);
  f.board(east, {1.55F, 2.85F}, {1.15F, 2.0F}, f.whiteboard);
  f.poster(south, 3.3F, 1.1F, 0.5F, 0.7F);
  f.poster(south, 2.4F, 1.2F, 0.4F, 0.55F);
  f.sign(south, 4.2F, 1.4F, 0.21F, 0.297F);
  f.window(north, {2.6F, 4.2F}, {0.9F, 2.1F});
  f.radiator(north, {2.7F, 4.1F});
  f.door(west, 1.6F, 0.9F, 2.03F);
  f.poster(west, 3.0F, 1.1F, 0.5F, 0.7F);
  b.ceiling_panel(1.6F, kDeskWidth / 2, kDeskHeight, 0.3F, 0.6F, 9);
  b.ceiling_panel(3.6F, kDeskWidth / 2, kDeskHeight, 0.3F, 0.6F, 9);

  Scene& scene = b.scene();
  scene.ambient = 0.32F;
  scene.lightmap_step_m = 0.035F;
  scene.ambient_reach_m = 0.6F;
  scene.speed_mps = 0.35F;
  scene.free_lo = {1.2F, 1.2F, 1.0F};
  scene.free_hi = {2.4F, 2.9F, 1.8F};
  scene.stroll = {{{2.0F, 2.0F, 1.4F}, 0.02F, -0.32F},  {{2.2F, 1.6F, 1.35F}, 0.25F, -0.38F},
                  {{2.35F, 1.3F, 1.3F}, 0.42F, -0.35F}, {{2.2F, 1.7F, 1.45F}, 0.1F, -0.42F},
                  {{2.1F, 2.3F, 1.4F}, -0.15F, -0.35F}, {{2.2F, 2.8F, 1.3F}, -0.45F, -0.3F},
                  {{1.8F, 2.6F, 1.35F}, -0.3F, -0.28F}, {{1.75F, 2.2F, 1.4F}, -0.08F, -0.25F}};
  return b.finish();
}

}  // namespace plvo::sim
