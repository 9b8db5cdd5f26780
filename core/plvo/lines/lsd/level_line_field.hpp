// SPDX-License-Identifier: Apache-2.0
// The gradient field that the segment detector works on (Grompone von Gioi, Jakubowicz, Morel, Randall, "LSD:
// a fast line segment detector with a false detection control", PAMI 2010, section 2.1–2.2): 2×2 gradients of
// an 8-bit image, over integers, as unit vectors (no angle is ever computed: two directions are compared by
// their cross and dot product), their magnitude, and the pseudo-ordering of the pixels by magnitude. Pixels
// whose gradient may be an effect of quantisation alone have no direction and take no part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/image/image_view.hpp"

namespace plvo::lsd {

// A pixel of the field; x and y count from 0 without the border. Neither it nor Direction has initialisers:
// a frame's scratch holds a million of them, all of which are written before they are read. Aligned as the
// numbers that take a region's place (lsd.hpp).
struct alignas(std::int32_t) Pixel {
  std::int16_t x;
  std::int16_t y;
};

// The direction of the gradient, towards the brighter side; length 2^14, or 0 for "none".
struct Direction {
  std::int16_t x;
  std::int16_t y;
};

inline constexpr int kDirectionBits = 14;

// How often a pixel may be added to a region before it stays where it is: what bounds the detector's time.
inline constexpr std::uint8_t kMaxGrowths = 6;
inline constexpr std::uint8_t kUsed = 0x80;         // bit of state: in a region, or must not be in one
inline constexpr std::uint8_t kGrowthsMask = 0x7f;  // bits of state: how often it was added to a region

// Grid (width − 1) × (height − 1) of the image, with a border of one pixel that is always used. Entry (x, y)
// is the gradient at the corner that pixels (x, y) … (x + 1, y + 1) share, that is at (x + ½, y + ½) of the
// image.
struct LevelLineField {
  int width = 0;
  int height = 0;
  int stride = 0;
  std::span<std::uint8_t> state;
  std::span<Direction> direction;
  std::span<std::uint16_t> magnitude;  // 1/32 grey level per pixel; set only where there is a direction
  std::span<Pixel> seeds;              // capacity: width · height
  std::size_t seed_count = 0;

  std::size_t index(int x, int y) const { return static_cast<std::size_t>((y + 1) * stride + x + 1); }
};

// Takes the field's arrays for an image of that size.
constexpr LevelLineField carve_field(Arena& memory, int image_width, int image_height) {
  LevelLineField field;
  field.width = image_width > 1 ? image_width - 1 : 0;
  field.height = image_height > 1 ? image_height - 1 : 0;
  field.stride = field.width + 2;
  const std::size_t padded =
      static_cast<std::size_t>(field.stride) * static_cast<std::size_t>(field.height + 2);
  const std::size_t pixels = static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height);
  field.state = memory.take<std::uint8_t>("lines/lsd", padded);
  field.direction = memory.take<Direction>("lines/lsd", padded);
  field.magnitude = memory.take<std::uint16_t>("lines/lsd", padded);
  field.seeds = memory.take<Pixel>("lines/lsd", pixels);
  return field;
}

// Unit vector and magnitude of an integer gradient in half grey levels, |gx|, |gy| ≤ 510, not both 0. The
// direction is off by at most 0.03°, the magnitude (1/32 grey level) by at most 0.1 %.
struct PolarGradient {
  Direction direction{};
  std::uint16_t magnitude = 0;
};
PolarGradient polar_gradient(int gx, int gy);

// Fills the field from image, and its seeds: every pixel with a direction, strongest first in 1024 bins,
// in raster order within a bin. unordered: scratch for width · height pixels, free again on return.
void compute_field(GrayView image, LevelLineField& field, std::span<Pixel> unordered);

}  // namespace plvo::lsd
