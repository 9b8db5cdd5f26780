// SPDX-License-Identifier: Apache-2.0
// Region growing (LSD, section 2.3): pixels that touch and whose gradient points the same way up to a
// tolerance. The region's direction is that of the sum of its unit vectors, renewed whenever the region has
// grown by an eighth: a neighbour's test does not wait for what the one before it changed. A pixel belongs to
// one region at a time and is added at most kMaxGrowths times in its life, so that all growing together takes
// at most 8 · kMaxGrowths looks per pixel of the image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/lines/lsd/level_line_field.hpp"

namespace plvo::lsd {

// A tolerance of an angle below 90°, as its tangent · 2^15.
struct Tolerance {
  std::int32_t tangent_q15 = 0;
};

inline constexpr Tolerance kTau{13573};  // 22.5°: tan = √2 − 1
// Directions are off by up to 0.03°: with less, pixels of one direction would not hold together.
inline constexpr Tolerance kLeastTolerance{18};

struct Region {
  std::span<Pixel> pixels;  // the seed first
  std::int64_t sum_x = 0;   // of the directions
  std::int64_t sum_y = 0;
};

// Grows from seed into storage (capacity: every pixel of the field) and marks what it takes as used.
Region grow(LevelLineField& field, Pixel seed, Tolerance tolerance, std::span<Pixel> storage);

// Gives the region's pixels back, but for those that have been added kMaxGrowths times.
void release(LevelLineField& field, std::span<const Pixel> pixels);

}  // namespace plvo::lsd
