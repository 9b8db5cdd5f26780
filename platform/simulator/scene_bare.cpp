// SPDX-License-Identifier: Apache-2.0
// A bare room of 6 × 5 m: white walls, a plain floor with skirting, a door, a window; only the wall ahead is
// textured (bricks with a few posters). What is left of it when the camera turns away is corners and edges:
// hard for points.
#include "plvo/simulator/scene_builder.hpp"

namespace plvo::sim {
namespace {

constexpr float kLength = 6;  // x
constexpr float kWidth = 5;   // y
constexpr float kHeight = 2.7F;

}  // namespace

std::unique_ptr<Scene> build_bare(std::uint64_t seed) {
  SceneBuilder b(seed);
  const auto floor = b.material({.pattern = Pattern::kLinoleum,
                                 .base = b.colour(0.33F, 0.15F),
                                 .second = {0.12F, 0.11F, 0.1F},
                                 .contrast = 0.5F,
                                 .gloss = 0.15F});
  const auto ceiling = b.material({.base = {0.78F, 0.78F, 0.76F}});
  const auto wall = b.material({.pattern = Pattern::kPlaster,
                                .base = b.colour(0.68F, 0.1F),
                                .second = {0.25F, 0.23F, 0.2F},
                                .contrast = 0.6F,
                                .infrared = 0.7F});
  const auto bricks = b.material({.pattern = Pattern::kBricks,
                                  .base = {0.42F, 0.2F, 0.13F},
                                  .second = {0.55F, 0.52F, 0.48F},
                                  .contrast = 1.6F});
  const auto skirting =
      b.material({.pattern = Pattern::kWood, .base = {0.2F, 0.12F, 0.07F}, .second = {0.1F, 0.05F, 0.03F}});
  const auto white = b.material({.base = {0.75F, 0.74F, 0.72F}, .gloss = 0.2F});
  const auto window =
      b.material({.pattern = Pattern::kWindow, .base = {0.7F, 0.7F, 0.7F}, .gloss = 0.5F, .emission = 1.2F});
  const auto door = b.material({.pattern = Pattern::kWood,
                                .base = {0.5F, 0.33F, 0.18F},
                                .second = {0.36F, 0.21F, 0.1F},
                                .gloss = 0.1F});
  const auto metal = b.material({.base = {0.5F, 0.5F, 0.5F}, .gloss = 0.7F, .infrared = 0.3F});

  b.shell({0, 0, 0}, {kLength, kWidth, kHeight}, floor, ceiling, wall);
  b.scene().solids[3].material.fill(bricks);  // the wall at x = kLength
  for (const float y : {0.0F, kWidth - 0.015F}) b.box({0, y, 0}, {kLength, y + 0.015F, 0.09F}, skirting);
  b.box({0, 0, 0}, {0.015F, kWidth, 0.09F}, skirting);

  // Posters on the bricks.
  const int posters = 4 + static_cast<int>(b.uniform(0, 2.99F));
  for (int k = 0; k < posters; ++k) {
    const float slot = kWidth / static_cast<float>(posters);
    const float y = (static_cast<float>(k) + 0.5F) * slot + b.uniform(-0.12F, 0.12F);
    const float z = b.uniform(1.1F, 1.7F);
    const float half_y = b.uniform(0.2F, 0.34F);
    const float half_z = half_y * b.uniform(0.75F, 1.4F);
    const auto poster = b.material({.pattern = Pattern::kPoster,
                                    .base = b.colour(0.7F, 0.3F),
                                    .second = {0.03F, 0.03F, 0.04F},
                                    .gloss = 0.1F});
    b.box({kLength - 0.02F, y - half_y - 0.015F, z - half_z - 0.015F},
          {kLength, y + half_y + 0.015F, z + half_z + 0.015F}, skirting);
    Solid& sheet =
        b.box({kLength - 0.025F, y - half_y, z - half_z}, {kLength - 0.001F, y + half_y, z + half_z}, poster);
    (void)sheet;
  }
  // A door in the wall at y = kWidth, a window in the one at y = 0.
  const float door_x = b.uniform(2.6F, 3.6F);
  b.box({door_x - 0.08F, kWidth - 0.05F, 0}, {door_x, kWidth, 2.1F}, white);
  b.box({door_x + 0.9F, kWidth - 0.05F, 0}, {door_x + 0.98F, kWidth, 2.1F}, white);
  b.box({door_x - 0.08F, kWidth - 0.05F, 2.02F}, {door_x + 0.98F, kWidth, 2.1F}, white);
  b.box({door_x, kWidth - 0.02F, 0.005F}, {door_x + 0.9F, kWidth, 2.02F}, door);
  b.box({door_x + 0.8F, kWidth - 0.07F, 1.02F}, {door_x + 0.83F, kWidth, 1.05F}, metal);
  b.box({door_x + 0.7F, kWidth - 0.07F, 1.02F}, {door_x + 0.82F, kWidth - 0.05F, 1.04F}, metal);
  const float window_x = b.uniform(2.5F, 3.5F);
  Solid& pane = b.box({window_x, 0, 0.95F}, {window_x + 1.5F, 0.03F, 2.2F}, white);
  pane.material[3] = window;
  b.box({window_x - 0.05F, 0, 0.9F}, {window_x + 1.55F, 0.18F, 0.94F}, white);

  b.ceiling_panel(2, kWidth / 2, kHeight, 0.3F, 0.6F, 9);
  b.ceiling_panel(4.2F, kWidth / 2, kHeight, 0.3F, 0.6F, 9);

  Scene& scene = b.scene();
  scene.free_lo = {0.8F, 0.9F, 0.9F};
  scene.free_hi = {4.4F, 4.1F, 2};
  scene.stroll = {{{2.2F, 2.2F, 1.45F}, 0.05F, -0.05F}, {{2.9F, 1.7F, 1.4F}, 0.35F, -0.1F},
                  {{3.5F, 2.1F, 1.5F}, 0.2F, 0},        {{3.6F, 3.0F, 1.45F}, -0.2F, -0.1F},
                  {{2.8F, 3.3F, 1.5F}, -0.4F, -0.02F},  {{2.0F, 2.9F, 1.4F}, -0.15F, -0.08F}};
  return b.finish();
}

}  // namespace plvo::sim
