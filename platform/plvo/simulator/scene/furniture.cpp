// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/scene/furniture.hpp"

#include <algorithm>

#include "plvo/math/trigonometry.hpp"

namespace plvo::sim {

Furniture::Furniture(SceneBuilder& builder) : b_(builder) {
  const float warm = b_.uniform(0.8F, 1.1F);
  const Rgb wood{0.40F * warm, 0.25F * warm, 0.13F * warm};
  plaster = b_.material({.pattern = Pattern::kPlaster,
                         .base = b_.colour(0.66F, 0.12F),
                         .second = {0.2F, 0.18F, 0.16F},
                         .infrared = 0.7F});
  ceiling = b_.material({.pattern = Pattern::kGrid,
                         .base = {0.74F, 0.74F, 0.72F},
                         .second = {0.6F, 0.6F, 0.58F},
                         .scale = 0.6F});
  floor = b_.material({.pattern = Pattern::kLinoleum,
                       .base = b_.colour(0.28F, 0.25F),
                       .second = {0.1F, 0.1F, 0.1F},
                       .gloss = 0.35F,
                       .infrared = 0.5F});
  skirting_wood = b_.material({.pattern = Pattern::kWood, .base = wood * 0.35F, .second = wood * 0.2F});
  door_wood = b_.material(
      {.pattern = Pattern::kWood, .base = wood, .second = wood * 0.65F, .contrast = 1.2F, .gloss = 0.15F});
  frame_paint = b_.material({.base = b_.colour(0.2F, 0.6F), .gloss = 0.2F, .infrared = 0.5F});
  furniture_wood =
      b_.material({.pattern = Pattern::kWood, .base = wood * 1.3F, .second = wood * 0.9F, .gloss = 0.1F});
  white = b_.material({.base = {0.72F, 0.71F, 0.69F}, .gloss = 0.15F});
  black = b_.material({.base = {0.025F, 0.025F, 0.027F}, .gloss = 0.2F, .infrared = 0.08F});
  metal = b_.material({.base = {0.45F, 0.45F, 0.46F}, .gloss = 0.7F, .infrared = 0.25F});
  red = b_.material({.base = {0.5F, 0.03F, 0.03F}, .gloss = 0.3F, .infrared = 0.6F});
  cardboard = b_.material({.pattern = Pattern::kWood,
                           .base = {0.38F, 0.26F, 0.15F},
                           .second = {0.3F, 0.19F, 0.1F},
                           .contrast = 0.5F});
  rubber = b_.material({.base = {0.06F, 0.06F, 0.065F}, .infrared = 0.2F});
  whiteboard = b_.material({.pattern = Pattern::kWhiteboard,
                            .base = {0.8F, 0.8F, 0.8F},
                            .second = {0.05F, 0.08F, 0.3F},
                            .gloss = 0.45F,
                            .infrared = 0.5F});
}

Solid& Furniture::on_wall(const Wall& wall, Span along, Span out, Span up, std::uint16_t material) {
  const float near = std::min(wall.outward * out.lo, wall.outward * out.hi);
  const float far = std::max(wall.outward * out.lo, wall.outward * out.hi);
  const Float3 o = wall.origin;
  return wall.along_x ? b_.box({o.x + along.lo, o.y + near, o.z + up.lo},
                               {o.x + along.hi, o.y + far, o.z + up.hi}, material)
                      : b_.box({o.x + near, o.y + along.lo, o.z + up.lo},
                               {o.x + far, o.y + along.hi, o.z + up.hi}, material);
}

std::uint16_t Furniture::print() {
  return b_.material({.pattern = Pattern::kPoster,
                      .base = b_.colour(0.62F, 0.35F),
                      .second = {0.03F, 0.03F, 0.04F},
                      .gloss = 0.1F});
}

void Furniture::skirting(const Wall& wall, float length) {
  on_wall(wall, {0, length}, {0, 0.016F}, {0, 0.1F}, skirting_wood);
}

void Furniture::door(const Wall& wall, float along, float width, float height) {
  constexpr float kFrame = 0.07F;
  on_wall(wall, {along - kFrame, along}, {0, 0.05F}, {0, height + kFrame}, frame_paint);
  on_wall(wall, {along + width, along + width + kFrame}, {0, 0.05F}, {0, height + kFrame}, frame_paint);
  on_wall(wall, {along, along + width}, {0, 0.05F}, {height, height + kFrame}, frame_paint);
  on_wall(wall, {along, along + width}, {0, 0.015F}, {0.004F, height}, door_wood);
  const bool left = b_.chance(0.5F);
  const float handle = left ? along + 0.07F : along + width - 0.07F;
  const float inwards = left ? 1.0F : -1.0F;
  on_wall(wall, {handle - 0.02F, handle + 0.02F}, {0.015F, 0.02F}, {0.94F, 1.14F}, metal);
  on_wall(wall, {std::min(handle, handle + inwards * 0.13F), std::max(handle, handle + inwards * 0.13F)},
          {0.05F, 0.07F}, {1.04F, 1.06F}, metal);
  on_wall(wall, {handle - 0.01F, handle + 0.01F}, {0.02F, 0.07F}, {1.04F, 1.06F}, metal);
  if (b_.chance(0.4F))
    on_wall(wall, {along + 0.06F, along + width - 0.06F}, {0.015F, 0.019F}, {0.05F, 0.3F}, metal);
  // The room's number beside the door.
  sign(wall, left ? along + width + 0.16F : along - 0.36F, 1.55F, 0.2F, 0.12F);
}

void Furniture::window(const Wall& wall, Span along, Span up) {
  const auto glass = b_.material({.pattern = Pattern::kWindow,
                                  .base = {0.7F, 0.7F, 0.7F},
                                  .gloss = 0.6F,
                                  .infrared = 0.05F,
                                  .emission = 1.1F});
  on_wall(wall, along, {0, 0.02F}, up, white).material[wall.front()] = glass;
  const float middle = 0.5F * (along.lo + along.hi);
  on_wall(wall, {along.lo - 0.05F, along.lo}, {0, 0.05F}, {up.lo - 0.05F, up.hi + 0.05F}, frame_paint);
  on_wall(wall, {along.hi, along.hi + 0.05F}, {0, 0.05F}, {up.lo - 0.05F, up.hi + 0.05F}, frame_paint);
  on_wall(wall, {middle - 0.03F, middle + 0.03F}, {0, 0.04F}, up, frame_paint);
  on_wall(wall, along, {0, 0.05F}, {up.hi, up.hi + 0.05F}, frame_paint);
  on_wall(wall, {along.lo - 0.08F, along.hi + 0.08F}, {0, 0.16F}, {up.lo - 0.05F, up.lo}, white);
}

void Furniture::poster(const Wall& wall, float along, float up, float width, float height) {
  constexpr float kRim = 0.018F;
  on_wall(wall, {along - kRim, along + width + kRim}, {0, 0.012F}, {up - kRim, up + height + kRim},
          b_.chance(0.5F) ? black : white);
  on_wall(wall, {along, along + width}, {0.001F, 0.015F}, {up, up + height}, white).material[wall.front()] =
      print();
}

void Furniture::sign(const Wall& wall, float along, float up, float width, float height) {
  const auto face = b_.material(
      {.pattern = Pattern::kPaper, .base = b_.colour(0.5F, 0.5F), .second = {0.02F, 0.02F, 0.03F}});
  on_wall(wall, {along, along + width}, {0, 0.008F}, {up, up + height}, white).material[wall.front()] = face;
}

void Furniture::board(const Wall& wall, Span along, Span up, std::uint16_t surface) {
  constexpr float kRim = 0.03F;
  on_wall(wall, {along.lo - kRim, along.hi + kRim}, {0, 0.02F}, {up.lo - kRim, up.hi + kRim}, metal);
  on_wall(wall, along, {0.001F, 0.024F}, up, white).material[wall.front()] = surface;
}

void Furniture::extinguisher(const Wall& wall, float along) {
  const Float3 o = wall.origin;
  const float out = 0.1F * wall.outward;
  const Float3 at = wall.along_x ? Float3{o.x + along, o.y + out, o.z} : Float3{o.x + out, o.y + along, o.z};
  b_.cylinder(at + Float3{0, 0, 0.85F}, 0.075F, 0.22F, red);
  b_.cylinder(at + Float3{0, 0, 1.1F}, 0.03F, 0.04F, black);
  on_wall(wall, {along - 0.05F, along + 0.05F}, {0, 0.03F}, {0.8F, 1.0F}, metal);
  on_wall(wall, {along - 0.1F, along + 0.1F}, {0, 0.008F}, {1.55F, 1.75F}, red);
  on_wall(wall, {along - 0.05F, along + 0.05F}, {0, 0.01F}, {1.6F, 1.7F}, white);
}

void Furniture::radiator(const Wall& wall, Span along) {
  constexpr float kPitch = 0.07F;
  for (float s = along.lo; s + 0.05F <= along.hi; s += kPitch)
    on_wall(wall, {s, s + 0.05F}, {0.04F, 0.12F}, {0.14F, 0.74F}, white);
  on_wall(wall, along, {0.06F, 0.1F}, {0.18F, 0.22F}, white);
  on_wall(wall, along, {0.06F, 0.1F}, {0.66F, 0.7F}, white);
}

void Furniture::switches(const Wall& wall, float along) {
  on_wall(wall, {along, along + 0.085F}, {0, 0.012F}, {1.08F, 1.25F}, white);
  on_wall(wall, {along + 0.015F, along + 0.07F}, {0.012F, 0.017F}, {1.1F, 1.15F}, metal);
  on_wall(wall, {along + 0.015F, along + 0.07F}, {0.012F, 0.017F}, {1.18F, 1.23F}, metal);
}

void Furniture::table(Float3 lo, Float3 hi) {
  b_.box({lo.x, lo.y, hi.z - 0.03F}, hi, furniture_wood);
  for (const float x : {lo.x + 0.04F, hi.x - 0.09F}) {
    for (const float y : {lo.y + 0.04F, hi.y - 0.09F})
      b_.box({x, y, lo.z}, {x + 0.05F, y + 0.05F, hi.z - 0.03F}, metal);
  }
}

void Furniture::chair(Float3 at, float yaw, float seat_z) {
  const auto fabric = b_.material({.pattern = Pattern::kCarpet,
                                   .base = b_.colour(0.12F, 0.6F),
                                   .second = b_.colour(0.06F, 0.5F),
                                   .infrared = 0.4F});
  const float c = static_cast<float>(cos(static_cast<double>(yaw)));
  const float s = static_cast<float>(sin(static_cast<double>(yaw)));
  const auto place = [&](float x, float y, float z) {
    return Float3{at.x + c * x - s * y, at.y + s * x + c * y, at.z + z};
  };
  b_.turned_box(place(0, 0, seat_z), {0.22F, 0.22F, 0.03F}, yaw, 0, fabric);
  b_.turned_box(place(-0.24F, 0, seat_z + 0.32F), {0.02F, 0.2F, 0.22F}, yaw, 0.12F, fabric);
  for (const float x : {-0.19F, 0.19F}) {
    for (const float y : {-0.19F, 0.19F}) b_.rod(place(x, y, 0), place(x, y, seat_z - 0.03F), 0.013F, metal);
  }
}

void Furniture::monitor(Float3 foot, float yaw, float width) {
  const auto screen = b_.material({.pattern = Pattern::kScreen,
                                   .base = {0.02F, 0.02F, 0.022F},
                                   .gloss = 0.4F,
                                   .infrared = 0.06F,
                                   .emission = 0.8F});
  const float height = 0.6F * width;
  const Float3 up{0, 0, 1};
  b_.cylinder(foot + up * 0.01F, 0.11F, 0.01F, black);
  b_.turned_box(foot + up * 0.12F, {0.012F, 0.03F, 0.11F}, yaw, 0, black);
  const Float3 forward{static_cast<float>(cos(static_cast<double>(yaw))),
                       static_cast<float>(sin(static_cast<double>(yaw))), 0};
  Solid& panel = b_.turned_box(foot + up * (0.12F + 0.5F * height) + forward * 0.03F,
                               {0.022F, 0.5F * width, 0.5F * height}, yaw, 0.06F, black);
  panel.material[1] = screen;
}

void Furniture::books_lying(Float3 at, float yaw, int count) {
  for (int k = 0; k < count; ++k) {
    const float thick = b_.uniform(0.012F, 0.04F);
    Solid& book = b_.turned_box(at + Float3{0, 0, 0.5F * thick},
                                {b_.uniform(0.07F, 0.11F), b_.uniform(0.1F, 0.15F), 0.5F * thick},
                                yaw + b_.uniform(-0.25F, 0.25F), 0, white);
    book.material.fill(b_.material({.base = b_.colour(0.25F, 0.8F)}));
    book.material[5] = print();
    book.material[0] = white;
    at.z += thick;
  }
}

void Furniture::books_standing(Float3 lo, float length, bool along_x, float outward) {
  const auto spine = b_.material({.pattern = Pattern::kSpine, .gloss = 0.1F});
  const Wall wall{lo, along_x, outward};
  for (float s = 0; s < length;) {
    const float thick = b_.uniform(0.018F, 0.05F);
    if (s + thick > length) break;
    if (!b_.chance(0.12F))
      on_wall(wall, {s, s + thick - 0.001F}, {0.02F, b_.uniform(0.15F, 0.2F)}, {0, b_.uniform(0.19F, 0.28F)},
              spine);
    s += thick;
  }
}

void Furniture::shelf(Float3 lo, Float3 hi, bool along_x, float outward, int boards) {
  const Wall wall{lo, along_x, outward};
  const float length = along_x ? hi.x - lo.x : hi.y - lo.y;
  const float depth = along_x ? std::abs(hi.y - lo.y) : std::abs(hi.x - lo.x);
  const float height = hi.z - lo.z;
  for (const float s : {0.0F, length - 0.02F})
    on_wall(wall, {s, s + 0.02F}, {0, depth}, {0, height}, furniture_wood);
  on_wall(wall, {0, length}, {0, 0.01F}, {0, height}, furniture_wood);
  for (int k = 0; k <= boards; ++k) {
    const float z = static_cast<float>(k) * (height - 0.02F) / static_cast<float>(boards);
    on_wall(wall, {0.02F, length - 0.02F}, {0.01F, depth}, {z, z + 0.02F}, furniture_wood);
    if (k < boards) {
      const Float3 start = along_x ? Float3{lo.x + 0.03F, lo.y, lo.z + z + 0.02F}
                                   : Float3{lo.x, lo.y + 0.03F, lo.z + z + 0.02F};
      books_standing(start, (length - 0.06F) * b_.uniform(0.6F, 1), along_x, outward);
    }
  }
}

void Furniture::cardboard_box(Float3 at, Float3 half, float yaw) {
  Solid& box = b_.turned_box(at + Float3{0, 0, half.z}, half, yaw, 0, cardboard);
  (void)box;
  const auto label =
      b_.material({.pattern = Pattern::kPaper, .base = {0.7F, 0.7F, 0.7F}, .second = {0.03F, 0.03F, 0.03F}});
  b_.turned_box(at + Float3{0, 0, 1.1F * half.z}, {half.x + 0.002F, 0.4F * half.y, 0.4F * half.z}, yaw, 0,
                label);
  b_.turned_box(at + Float3{0, 0, 2 * half.z}, {half.x + 0.001F, 0.025F, 0.002F}, yaw, 0, furniture_wood);
}

void Furniture::paper(Float3 at, float yaw) {
  const auto sheet = b_.material(
      {.pattern = Pattern::kPaper, .base = {0.78F, 0.78F, 0.77F}, .second = {0.04F, 0.04F, 0.05F}});
  b_.turned_box(at + Float3{0, 0, 0.001F}, {0.105F, 0.1485F, 0.001F}, yaw, 0, sheet);
}

void Furniture::mug(Float3 at) {
  const auto glaze = b_.material({.base = b_.colour(0.4F, 0.7F), .gloss = 0.5F});
  b_.cylinder(at + Float3{0, 0, 0.05F}, 0.04F, 0.05F, glaze).material[5] = black;
  b_.box(at + Float3{0.035F, -0.006F, 0.025F}, at + Float3{0.065F, 0.006F, 0.08F}, glaze);
}

void Furniture::bin(Float3 at) { b_.cylinder(at + Float3{0, 0, 0.17F}, 0.14F, 0.17F, rubber); }

}  // namespace plvo::sim
