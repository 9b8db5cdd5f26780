// SPDX-License-Identifier: Apache-2.0
// Samples of a frame's surfaces, from depth alone. They constrain the motion at bare walls without points or
// lines. A sample measures the position of its surface along the normal, and nothing else.
#pragma once

#include <cstddef>

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

struct SurfaceSample {
  Vector3 p = Vector3::Zero();       // camera frame, at the exposure time of its colour row, m
  Vector3 normal = Vector3::Zero();  // unit, towards the camera
  double variance = 0;               // variance of p along the normal, m²
  double normal_variance = 0;        // variance of the normal, in any direction across it, rad²
};

struct SurfaceFeatures {
  FixedVector<SurfaceSample> samples;

  constexpr void allocate(Arena& memory, int capacity) {
    if (capacity > 0)
      samples = FixedVector<SurfaceSample>(
          memory.take<SurfaceSample>("surface features", static_cast<std::size_t>(capacity)));
  }
};

}  // namespace plvo
