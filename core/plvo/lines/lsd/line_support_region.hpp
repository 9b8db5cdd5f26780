// SPDX-License-Identifier: Apache-2.0
// Region growing (LSD, section 2.3): pixels that touch and whose gradient points the same way up to a
// tolerance. A region grows by runs of rows: of the blocks around a run, those pixels that touch it, and
// in their blocks what touches them beside. The region's angle is the mean of those pixels whose runs have
// had their turn, renewed whenever these have become an eighth more. (The paper's is that of the sum of their
// unit vectors, which is nearly the same where all point nearly the same way.) A pixel belongs to one region
// at a time and is given back at most kMaxReleases times in its life, so that all growing together takes a
// bounded number of looks per pixel of the image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/lines/lsd/level_line_field.hpp"

namespace plvo::lsd {

inline constexpr Angle kTau = 4096;  // 22.5°
// Angles are off by up to 0.004°: with less, pixels of one direction would not hold together.
inline constexpr Angle kLeastTolerance = 3;

struct Region {
  std::span<Run> runs;    // no pixel is in two
  std::int32_t size = 0;  // pixels
  Run seed{};             // one pixel
  // What its pixels' angles are beyond one of them, summed.
  Angle from = 0;
  std::int32_t beyond = 0;

  Angle angle() const { return static_cast<Angle>(from + beyond / size); }  // the mean
};

// Grows from seed, one pixel, which is taken whether it is open or not, into storage (capacity: every pixel
// of the field and one more) and marks what it takes.
Region grow(LevelLineField& field, Run seed, Angle tolerance, std::span<Run> storage);

// Gives pixels back, but for those that have been given back kMaxReleases times.
void release(LevelLineField& field, Run run);

}  // namespace plvo::lsd
