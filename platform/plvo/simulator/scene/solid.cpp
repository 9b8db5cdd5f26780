// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/scene/solid.hpp"

#include <cmath>

#include "plvo/math/trigonometry.hpp"

namespace plvo::sim {
namespace {

constexpr float kTwoPi = 6.2831853F;

// The slab method (Kay & Kajiya, SIGGRAPH 1986), in the box's frame.
bool intersect_box(Float3 half, Float3 o, Float3 d, float t_min, float t_max, float& t, int& face) {
  float near = -1e30F;
  float far = 1e30F;
  int near_face = 0;
  int far_face = 0;
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      if (o[k] < -half[k] || o[k] > half[k]) return false;
      continue;
    }
    const float inverse = 1.0F / d[k];
    float enter = (-half[k] - o[k]) * inverse;
    float leave = (half[k] - o[k]) * inverse;
    int enter_face = 2 * k;
    if (enter > leave) {
      std::swap(enter, leave);
      ++enter_face;
    }
    if (enter > near) {
      near = enter;
      near_face = enter_face;
    }
    if (leave < far) {
      far = leave;
      far_face = enter_face ^ 1;
    }
  }
  if (near > far) return false;
  if (near > t_min && near < t_max) {
    t = near;
    face = near_face;
    return true;
  }
  if (near <= t_min && far > t_min && far < t_max) {
    t = far;
    face = far_face;
    return true;
  }
  return false;
}

bool intersect_cylinder(Float3 half, Float3 o, Float3 d, float t_min, float t_max, float& t, int& face) {
  const float a = d.x * d.x + d.y * d.y;
  const float b = o.x * d.x + o.y * d.y;
  const float c = o.x * o.x + o.y * o.y - half.x * half.x;
  float best = t_max;
  int best_face = -1;
  if (a > 0) {
    const float discriminant = b * b - a * c;
    if (discriminant < 0) return false;
    const float mantle = (-b - std::sqrt(discriminant)) / a;
    const float z = o.z + mantle * d.z;
    if (mantle > t_min && mantle < best && z >= -half.z && z <= half.z) {
      best = mantle;
      best_face = 0;
    }
  }
  if (d.z != 0) {
    const float cap = ((d.z < 0 ? half.z : -half.z) - o.z) / d.z;
    const float x = o.x + cap * d.x;
    const float y = o.y + cap * d.y;
    if (cap > t_min && cap < best && x * x + y * y <= half.x * half.x) {
      best = cap;
      best_face = d.z < 0 ? 5 : 4;
    }
  }
  if (best_face < 0) return false;
  t = best;
  face = best_face;
  return true;
}

}  // namespace

bool intersect(const Solid& solid, const Ray& ray, float t_min, float t_max, float& t, int& face) {
  const Float3 o = solid.to_local(ray.origin);
  const Float3 d = solid.rotate_to_local(ray.direction);
  return solid.shape == Solid::Shape::kBox ? intersect_box(solid.half, o, d, t_min, t_max, t, face)
                                           : intersect_cylinder(solid.half, o, d, t_min, t_max, t, face);
}

std::array<Float3, 3> axes_along(Float3 along) {
  const Float3 side =
      normalised(std::abs(along.z) < 0.9F ? cross(along, Float3{0, 0, 1}) : cross(along, Float3{1, 0, 0}));
  return {side, cross(along, side), along};
}

Float3 half_extent(const Solid& solid) {
  const Float3 h = solid.half;
  const auto& a = solid.axes;
  return {std::abs(a[0].x) * h.x + std::abs(a[1].x) * h.y + std::abs(a[2].x) * h.z,
          std::abs(a[0].y) * h.x + std::abs(a[1].y) * h.y + std::abs(a[2].y) * h.z,
          std::abs(a[0].z) * h.x + std::abs(a[1].z) * h.y + std::abs(a[2].z) * h.z};
}

void face_size(const Solid& solid, int face, float& size_u, float& size_v) {
  const Float3 h = solid.half;
  if (solid.shape == Solid::Shape::kCylinder && face == 0) {
    size_u = kTwoPi * h.x;
    size_v = 2 * h.z;
    return;
  }
  size_u = 2 * (face < 2 ? h.y : h.x);
  size_v = 2 * (face < 4 ? h.z : h.y);
}

FaceCoordinates face_coordinates(const Solid& solid, int face, Float3 local) {
  FaceCoordinates c;
  face_size(solid, face, c.size_u, c.size_v);
  const Float3 h = solid.half;
  if (solid.shape == Solid::Shape::kCylinder && face == 0) {
    const auto angle = static_cast<float>(atan2(static_cast<double>(local.y), static_cast<double>(local.x)));
    c.u = (angle < 0 ? angle + kTwoPi : angle) * h.x;
    c.v = local.z + h.z;
    return c;
  }
  c.u = face < 2 ? local.y + h.y : local.x + h.x;
  c.v = face < 4 ? local.z + h.z : local.y + h.y;
  return c;
}

Float3 face_point(const Solid& solid, int face, float u, float v) {
  const Float3 h = solid.half;
  if (solid.shape == Solid::Shape::kCylinder && face == 0) {
    const auto angle = static_cast<double>(u / h.x);
    return {h.x * static_cast<float>(cos(angle)), h.x * static_cast<float>(sin(angle)), v - h.z};
  }
  switch (face / 2) {
    case 0: return {face == 0 ? -h.x : h.x, u - h.y, v - h.z};
    case 1: return {u - h.x, face == 2 ? -h.y : h.y, v - h.z};
    default: return {u - h.x, v - h.y, face == 4 ? -h.z : h.z};
  }
}

Float3 face_normal(const Solid& solid, int face, Float3 local) {
  if (solid.shape == Solid::Shape::kCylinder && face == 0)
    return Float3{local.x, local.y, 0} * (1.0F / solid.half.x);
  const float sign = (face & 1) != 0 ? 1.0F : -1.0F;
  switch (face / 2) {
    case 0: return {sign, 0, 0};
    case 1: return {0, sign, 0};
    default: return {0, 0, sign};
  }
}

void face_axes(const Solid& solid, int face, Float3 local, Float3& axis_u, Float3& axis_v) {
  if (solid.shape == Solid::Shape::kCylinder && face == 0) {
    axis_u = Float3{-local.y, local.x, 0} * (1.0F / solid.half.x);
    axis_v = {0, 0, 1};
    return;
  }
  axis_u = face < 2 ? Float3{0, 1, 0} : Float3{1, 0, 0};
  axis_v = face < 4 ? Float3{0, 0, 1} : Float3{0, 1, 0};
}

}  // namespace plvo::sim
