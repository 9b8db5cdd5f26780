// SPDX-License-Identifier: Apache-2.0
// Furniture of the rooms: doors, windows, posters, tables, monitors … Each consists of a few boxes and
// cylinders. Objects on a wall are placed by their position along it, their distance from it and their
// height.
#pragma once

#include "plvo/simulator/scene/scene_builder.hpp"

namespace plvo::sim {

// The inner face of a wall. It runs from `origin` along +x or +y; `outward` is the sign of its normal along
// the other axis.
struct Wall {
  Float3 origin;
  bool along_x = true;
  float outward = 1;

  // Index of the face of a box on this wall that faces the room.
  std::size_t front() const { return (along_x ? 2U : 0U) + (outward > 0 ? 1U : 0U); }
};

// An interval along a wall, away from it or upwards.
struct Span {
  float lo = 0, hi = 0;
};

class Furniture {
 public:
  // Draws the colours of wood, paint and floor from the builder's seed.
  explicit Furniture(SceneBuilder& builder);

  Solid& on_wall(const Wall& wall, Span along, Span out, Span up, std::uint16_t material);

  void skirting(const Wall& wall, float length);
  void door(const Wall& wall, float along, float width, float height);
  void window(const Wall& wall, Span along, Span up);
  void poster(const Wall& wall, float along, float up, float width, float height);
  void sign(const Wall& wall, float along, float up, float width, float height);
  void board(const Wall& wall, Span along, Span up, std::uint16_t surface);  // framed
  void extinguisher(const Wall& wall, float along);
  void radiator(const Wall& wall, Span along);
  void switches(const Wall& wall, float along);

  void table(Float3 lo, Float3 hi);  // hi.z: height of the top
  void chair(Float3 at, float yaw, float seat_z);
  void monitor(Float3 foot, float yaw, float width);
  void books_lying(Float3 at, float yaw, int count);
  void books_standing(Float3 lo, float length, bool along_x, float outward);
  void shelf(Float3 lo, Float3 hi, bool along_x, float outward, int boards);
  void cardboard_box(Float3 at, Float3 half, float yaw);
  void paper(Float3 at, float yaw);
  void mug(Float3 at);
  void bin(Float3 at);

  std::uint16_t plaster, ceiling, floor, skirting_wood, door_wood, frame_paint, furniture_wood, white, black,
      metal, red, cardboard, rubber, whiteboard;

 private:
  std::uint16_t print();  // a new poster's material

  SceneBuilder& b_;
};

}  // namespace plvo::sim
