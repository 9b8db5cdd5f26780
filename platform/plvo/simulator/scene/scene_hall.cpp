// SPDX-License-Identifier: Apache-2.0
// An entrance hall of 13 × 10 × 4 m: pillars, tiles, benches, a counter, notice boards. Much of it lies
// beyond the range of the depth sensor.
#include "plvo/math/trigonometry.hpp"
#include "plvo/simulator/scene/furniture.hpp"

namespace plvo::sim {
namespace {

constexpr float kHallLength = 13;
constexpr float kHallWidth = 10;
constexpr float kHallHeight = 4;

void bench(SceneBuilder& b, Furniture& f, float x, float y) {
  for (int k = 0; k < 4; ++k) {
    const float lo = y - 0.22F + 0.115F * static_cast<float>(k);
    b.box({x - 0.75F, lo, 0.42F}, {x + 0.75F, lo + 0.095F, 0.46F}, f.furniture_wood);
  }
  for (const float s : {-0.6F, 0.56F}) b.box({x + s, y - 0.2F, 0}, {x + s + 0.04F, y + 0.2F, 0.42F}, f.metal);
}

void pillar(SceneBuilder& b, Furniture& f, float x, float y) {
  constexpr float kHalf = 0.22F;
  b.box({x - kHalf, y - kHalf, 0}, {x + kHalf, y + kHalf, kHallHeight}, f.plaster);
  b.box({x - kHalf - 0.02F, y - kHalf - 0.02F, 0}, {x + kHalf + 0.02F, y + kHalf + 0.02F, 0.12F},
        f.skirting_wood);
  const Wall side{{x - kHalf, y - kHalf, 0}, true, -1};
  f.poster(side, 0.06F, b.uniform(1.2F, 1.5F), 0.32F, 0.45F);
  const Wall front{{x - kHalf, y - kHalf, 0}, false, -1};
  f.sign(front, 0.1F, b.uniform(1.4F, 1.7F), 0.24F, 0.3F);
}

}  // namespace

std::unique_ptr<Scene> build_hall(std::uint64_t seed) {
  SceneBuilder b(seed);
  Furniture f(b);
  const auto tiles = b.material({.pattern = Pattern::kTiles,
                                 .base = b.colour(0.4F, 0.15F),
                                 .second = {0.15F, 0.14F, 0.13F},
                                 .scale = 0.5F,
                                 .gloss = 0.3F});
  const auto cork = b.material(
      {.pattern = Pattern::kCarpet, .base = {0.36F, 0.24F, 0.13F}, .second = {0.24F, 0.15F, 0.08F}});
  b.shell({0, 0, 0}, {kHallLength, kHallWidth, kHallHeight}, tiles, f.ceiling, f.plaster);
  const Wall south{{0, 0, 0}, true, 1};
  const Wall north{{0, kHallWidth, 0}, true, -1};
  const Wall west{{0, 0, 0}, false, 1};
  const Wall east{{kHallLength, 0, 0}, false, -1};
  f.skirting(south, kHallLength);
  f.skirting(north, kHallLength);
  f.skirting(west, kHallWidth);
  f.skirting(east, kHallWidth);

  for (float s = 1; s < 12; s += 2.6F) f.window(south, {s, s + 1.5F}, {0.9F, 2.8F});
  for (float s = 0.8F; s < 11; s += 3.1F) f.door(north, s, 1.0F, 2.1F);
  for (float s = 2.2F; s < 11; s += 3.1F) f.poster(north, s, b.uniform(1.1F, 1.3F), 0.6F, 0.85F);
  f.board(east, {1.2F, 3.4F}, {1.0F, 2.1F}, cork);
  for (int k = 0; k < 6; ++k)
    f.sign(Wall{{kHallLength - 0.024F, 0, 0}, false, -1}, 1.3F + 0.34F * static_cast<float>(k),
           1.1F + 0.45F * static_cast<float>(k % 2) + b.uniform(0, 0.1F), 0.21F, 0.297F);
  f.door(east, 4.4F, 1.8F, 2.2F);
  f.poster(east, 7.2F, 1.0F, 0.9F, 1.25F);
  f.board(west, {2.5F, 4.5F}, {0.9F, 2.1F}, f.whiteboard);
  f.poster(west, 5.2F, 1.1F, 0.6F, 0.85F);
  f.poster(west, 6.1F, 1.1F, 0.6F, 0.85F);
  f.extinguisher(west, 7.4F);

  for (const float x : {3.6F, 9.4F}) {
    for (const float y : {2.6F, 7.4F}) pillar(b, f, x, y);
  }
  for (const float x : {4.2F, 6.3F, 8.4F}) bench(b, f, x, b.uniform(5.2F, 5.6F));
  // The counter with its monitor, papers and a bin.
  b.box({10.6F, 6.4F, 0}, {11.1F, 9.2F, 1.05F}, f.furniture_wood);
  b.box({10.55F, 6.35F, 1.05F}, {11.2F, 9.25F, 1.09F}, f.white);
  f.monitor({10.9F, 7.2F, 1.09F}, 2.9F, 0.5F);
  f.paper({10.8F, 8.0F, 1.09F}, 0.4F);
  f.books_lying({10.8F, 8.6F, 1.09F}, 0.2F, 3);
  f.bin({3.6F, 3.2F, 0});
  f.cardboard_box({9.4F, 6.7F, 0}, {0.25F, 0.2F, 0.2F}, 0.3F);
  f.table({4.8F, 7.8F, 0}, {6.2F, 8.5F, 0.74F});
  f.books_lying({5.2F, 8.1F, 0.74F}, 0.5F, 2);
  f.paper({5.7F, 8.2F, 0.74F}, 1.2F);
  f.chair({5.5F, 7.4F, 0}, 1.6F, 0.45F);
  for (const float x : {2.2F, 6.5F, 10.8F}) {
    for (const float y : {2.5F, 7.5F}) b.ceiling_panel(x, y, kHallHeight, 0.6F, 0.6F, 26);
  }

  Scene& scene = b.scene();
  scene.ambient = 0.4F;
  scene.ambient_reach_m = 1.5F;
  scene.lightmap_step_m = 0.08F;
  scene.speed_mps = 0.7F;
  scene.free_lo = {6.6F, 3.2F, 0.9F};
  scene.free_hi = {9.0F, 4.4F, 1.9F};
  scene.stroll = {{{7.2F, 4.0F, 1.5F}, 0.3F, -0.14F},  {{7.8F, 3.8F, 1.5F}, 0.5F, -0.16F},
                  {{8.4F, 3.5F, 1.5F}, 0.75F, -0.12F}, {{8.9F, 3.6F, 1.5F}, 0.4F, -0.12F},
                  {{9.0F, 4.1F, 1.5F}, 0.05F, -0.1F},  {{8.5F, 4.4F, 1.5F}, -0.3F, -0.14F},
                  {{7.8F, 4.3F, 1.5F}, 0.0F, -0.12F}};
  // The path leads around the benches between the pillars. The camera looks in the direction of motion,
  // slightly outwards.
  constexpr int kPoints = 16;
  for (int k = 0; k < kPoints; ++k) {
    const double angle = 2 * kPi * k / kPoints;
    scene.round.push_back(
        {{6.5F + 4.3F * static_cast<float>(sin(angle)), 5.0F - 1.55F * static_cast<float>(cos(angle)), 1.5F},
         static_cast<float>(angle) - 0.25F + b.uniform(-0.1F, 0.1F),
         -0.12F});
  }
  return b.finish();
}

}  // namespace plvo::sim
