// SPDX-License-Identifier: Apache-2.0
// The gradient field of the segment detector (Grompone von Gioi, Jakubowicz, Morel, Randall, "LSD: a fast
// line segment detector with a false detection control", PAMI 2010, section 2.1–2.2): 2×2 gradients of an
// 8-bit image as angles and magnitudes, and the pseudo-ordering of the pixels by magnitude. Pixels whose
// gradient may be caused by quantisation alone have no angle and are ignored. A row consists of blocks of
// eight pixels, which are processed together. A flag per pixel is one bit of a byte per block.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/bits.hpp"
#include "plvo/image/image_mask.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::lsd {

// 2^16 units per turn, from the x axis towards the y axis. Differences wrap around by themselves.
using Angle = std::int16_t;
inline constexpr double kAnglePerRadian = 32768 / kPi;

inline constexpr int kBlockPixels = 8;

// A run: some pixels of one block. Bit i is the pixel (8 · block + i, row), counted from 0. There are no
// initialisers, because a frame's scratch holds a hundred thousand runs, all written before they are read.
struct PixelRun {
  std::uint16_t row;
  std::uint8_t block;
  std::uint8_t bits;
};

// Limit of the releases of a pixel, which bounds the detector's time. A pixel is added to regions at most
// once more than that.
inline constexpr int kMaxReleases = 5;

// The grid has (width − 1) × (height − 1) entries for the image. Entry (x, y) is the gradient at the corner
// that pixels (x, y) … (x + 1, y + 1) share, which is (x + ½, y + ½) of the image.
struct LevelLineField {
  static constexpr int kMostWidth = 256 * kBlockPixels;

  int width = 0;
  int height = 0;
  int stride = 0;  // blocks of a row, plus one without pixels between the last block and the next row's first
  // Per block: `directed` marks the pixels that have an angle, `open` those of them that belong to no region.
  // Per pixel with an angle: the angle of the gradient, towards the brighter side; and the magnitude, in 1/16
  // grey level per pixel, with the number of releases from kReleaseBit on. The padded arrays have an
  // additional row before the first and after the last one, without open pixels, because region growing reads
  // around its runs.
  std::span<std::uint8_t> directed;
  std::span<std::uint8_t> padded_open;
  std::span<Angle> padded_angles;
  std::span<std::int16_t> magnitude_and_releases;
  std::span<PixelRun> seeds;  // one pixel each; capacity: all pixels of all blocks
  std::size_t seed_count = 0;

  static constexpr int kReleaseBit = 13;

  std::ptrdiff_t index(int block, int row) const { return row * std::ptrdiff_t{stride} + block; }
  std::ptrdiff_t index(PixelRun run) const { return index(run.block, run.row); }
  // Pointers to block 0. index() gives the other blocks relative to it.
  std::uint8_t* open() const { return padded_open.data() + stride + 1; }
  Angle* angles() const { return padded_angles.data() + (stride + 1) * kBlockPixels; }
  std::ptrdiff_t pixel(int x, int y) const { return index(0, y) * kBlockPixels + x; }
};

// Takes the field's arrays for an image of that size, at most LevelLineField::kMostWidth wide.
constexpr LevelLineField allocate_field(Arena& memory, int image_width, int image_height) {
  LevelLineField field;
  field.width = image_width > 1 ? image_width - 1 : 0;
  field.height = image_height > 1 ? image_height - 1 : 0;
  field.stride = (field.width + kBlockPixels - 1) / kBlockPixels + 1;
  const auto stride = static_cast<std::size_t>(field.stride);
  const auto rows = static_cast<std::size_t>(field.height);
  const std::size_t padded = stride * (rows + 2) + 2;
  field.directed = memory.take<std::uint8_t>("lines/lsd", stride * rows);
  field.padded_open = memory.take<std::uint8_t>("lines/lsd", padded);
  field.padded_angles = memory.take<Angle>("lines/lsd", padded * kBlockPixels);
  field.magnitude_and_releases = memory.take<std::int16_t>("lines/lsd", stride * rows * kBlockPixels);
  field.seeds = memory.take<PixelRun>("lines/lsd", (stride - 1) * rows * kBlockPixels);
  return field;
}

// Column of the first and of the last pixel of a run.
inline int first_x(PixelRun run) { return run.block * kBlockPixels + lowest_bit(run.bits); }
inline int last_x(PixelRun run) { return run.block * kBlockPixels + highest_bit(run.bits); }

// Angle and magnitude of an integer gradient in half grey levels, |gx|, |gy| ≤ 510, not both 0. The error is
// at most 0.004° in the angle and half a unit in the magnitude (unit: 1/16 grey level).
struct PolarGradient {
  Angle angle = 0;
  std::int16_t magnitude = 0;
};
PolarGradient polar_gradient(int gx, int gy);

// The mask of the full image. Pixel (x, y) of the field's image is at (scale x, scale (row_0 + y)) of it.
struct FieldMask {
  const ImageMask* mask = nullptr;  // nullptr: none
  double scale = 1;
  int row_0 = 0;
};

// Computes the field of an image, and its seeds: every pixel with an angle, strongest first in 1024 bins, in
// raster order within a bin. Pixels near masked ones have no angle.
void compute_field(GrayView image, LevelLineField& field, const FieldMask& masked = {});

}  // namespace plvo::lsd
