// SPDX-License-Identifier: Apache-2.0
// Three floats: a point, a direction or a linear colour. The renderer traces millions of rays, also in debug
// builds. There the expression templates of a matrix library would take ten times as long as these plain
// functions.
#pragma once

#include <algorithm>
#include <cmath>

#include "plvo/math/types.hpp"

namespace plvo::sim {

struct Float3 {
  float x = 0, y = 0, z = 0;

  float operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
};

inline Float3 to_float(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
inline Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Float3 operator-(Float3 a) { return {-a.x, -a.y, -a.z}; }
inline Float3 operator*(Float3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Float3 operator*(float s, Float3 a) { return a * s; }
inline Float3 operator*(Float3 a, Float3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Float3 cross(Float3 a, Float3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Float3 min3(Float3 a, Float3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Float3 max3(Float3 a, Float3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline float norm(Float3 a) { return std::sqrt(dot(a, a)); }
inline Float3 normalised(Float3 a) { return a * (1.0F / norm(a)); }
inline Float3 mix(Float3 a, Float3 b, float t) { return a + (b - a) * t; }
inline float mix(float a, float b, float t) { return a + (b - a) * t; }
inline float clamp01(float x) { return x < 0 ? 0.0F : (x > 1 ? 1.0F : x); }

using Rgb = Float3;  // linear, not gamma encoded
inline float luminance(Rgb c) { return 0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z; }

}  // namespace plvo::sim
