// SPDX-License-Identifier: Apache-2.0
// The solids of a room: boxes and cylinders (along z in their own frame), placed by a rotation and a centre
// and intersected analytically. World axes: x and y on the floor, z up, metres.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/simulator/float3.hpp"

namespace plvo::sim {

struct Ray {
  Float3 origin;
  Float3 direction;  // of any length, which is the unit of the parameter t
};

struct Solid {
  enum class Shape : std::uint8_t { kBox, kCylinder };
  static constexpr int kFaces =
      6;  // −x +x −y +y −z +z; face 0 of a cylinder is its lateral surface, faces 4 and 5 are its caps

  Shape shape = Shape::kBox;
  bool aligned = true;  // parallel to the world axes
  Float3 centre;
  Float3 half;  // box: half edges; cylinder: (radius, radius, half length)
  std::array<Float3, 3> axes = {Float3{1, 0, 0}, Float3{0, 1, 0}, Float3{0, 0, 1}};
  std::array<std::uint16_t, kFaces> material{};
  std::uint32_t seed = 0;  // seed of the texture

  Float3 to_local(Float3 world) const { return rotate_to_local(world - centre); }
  Float3 rotate_to_local(Float3 v) const {
    return aligned ? v : Float3{dot(axes[0], v), dot(axes[1], v), dot(axes[2], v)};
  }
  Float3 rotate_to_world(Float3 v) const {
    return aligned ? v : axes[0] * v.x + axes[1] * v.y + axes[2] * v.z;
  }
  Float3 to_world(Float3 local) const { return rotate_to_world(local) + centre; }
};

struct Hit {
  float t = 0;
  int solid = -1;  // −1: no hit
  int face = 0;

  // Index of the face that was hit, unique over all solids.
  int surface() const { return solid * Solid::kFaces + face; }
};

// First intersection with the solid's surface at t in (t_min, t_max); returns false if there is none. A ray
// that starts inside hits the far side.
bool intersect(const Solid& solid, const Ray& ray, float t_min, float t_max, float& t, int& face);

// Coordinates on a face, in metres from its lower corner, and the face's size. On the lateral surface of a
// cylinder, u runs along the circumference.
struct FaceCoordinates {
  float u = 0, v = 0;
  float size_u = 0, size_v = 0;
};
FaceCoordinates face_coordinates(const Solid& solid, int face, Float3 local);
// The inverse: the point at (u, v) of a face, in the solid's frame.
Float3 face_point(const Solid& solid, int face, float u, float v);
// Outward unit normal at a local point of a face, in the solid's frame.
Float3 face_normal(const Solid& solid, int face, Float3 local);
// Local axes along which u and v grow (unit vectors, solid's frame).
void face_axes(const Solid& solid, int face, Float3 local, Float3& axis_u, Float3& axis_v);
// Axes of a solid whose z axis has this direction (a unit vector).
std::array<Float3, 3> axes_along(Float3 along);
// Half the size of the box that is parallel to the world axes and contains the solid.
Float3 half_extent(const Solid& solid);
// Size of a face in metres.
void face_size(const Solid& solid, int face, float& size_u, float& size_v);

}  // namespace plvo::sim
