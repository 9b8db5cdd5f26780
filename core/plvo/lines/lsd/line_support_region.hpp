// SPDX-License-Identifier: Apache-2.0
// Region growing (LSD, section 2.3): connects touching pixels whose gradients have the same direction up to a
// tolerance. A region grows by runs of rows: in the blocks around a run, it takes the pixels that touch the
// run, and the pixels of the same block that are connected to them. The region's angle is the mean over the
// pixels of the runs processed so far; it is updated whenever their number has grown by an eighth. (The paper
// uses the angle of the sum of their unit vectors, which is nearly the same for nearly parallel vectors.) A
// pixel belongs to one region at a time and is released at most kMaxReleases times. The growing of all
// regions therefore takes a bounded time per pixel of the image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/lines/lsd/level_line_field.hpp"

namespace plvo::lsd {

inline constexpr Angle kTau = 4096;  // 22.5°
// Angles have errors up to 0.004°. A smaller tolerance would separate pixels of one direction.
inline constexpr Angle kLeastTolerance = 3;

struct Region {
  std::span<PixelRun> runs;  // disjoint
  std::int32_t size = 0;     // pixels
  PixelRun seed{};           // one pixel
  // Sum of the differences between the pixels' angles and `from`.
  Angle from = 0;
  std::int32_t beyond = 0;

  Angle angle() const { return static_cast<Angle>(from + beyond / size); }  // the mean
};

// Grows a region from a seed of one pixel, which is taken whether it is open or not. storage receives the
// runs (capacity: every pixel of the field and one more). The taken pixels are no longer open.
Region grow(LevelLineField& field, PixelRun seed, Angle tolerance, std::span<PixelRun> storage);

// Makes the pixels of a run open again, except those that have been released kMaxReleases times.
void release(LevelLineField& field, PixelRun run);

}  // namespace plvo::lsd
