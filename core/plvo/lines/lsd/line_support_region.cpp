// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/line_support_region.hpp"

#include <bit>

namespace plvo::lsd {

namespace {

// The eight neighbours, row by row.
constexpr std::int8_t kRight[] = {-1, 0, 1, -1, 1, -1, 0, 1};
constexpr std::int8_t kDown[] = {-1, -1, -1, 0, 0, 1, 1, 1};

// A pixel's two numbers, or a step's, as one: x, and y from bit 16 on. Then a step to a neighbour is one
// addition; no pixel's number is negative in the field, so nothing is left carried.
std::uint32_t packed(const Pixel& pixel) {
  return static_cast<std::uint32_t>(pixel.x) + (static_cast<std::uint32_t>(pixel.y) << 16);
}
Pixel unpacked(std::uint32_t pixel) {
  return {static_cast<std::int16_t>(pixel), static_cast<std::int16_t>(pixel >> 16)};
}

// Bit i: neighbour i is in no region yet. Byte by byte: a wide load would wait for the narrow stores of
// pixels that were just taken.
unsigned open_neighbours(const std::uint8_t* state, std::ptrdiff_t stride) {
  static_assert(kUsed == 1U << 7);
  const std::uint8_t* const above = state - stride;
  const std::uint8_t* const below = state + stride;
  const unsigned used = (above[-1] & kUsed) >> 7 | (above[0] & kUsed) >> 6 | (above[1] & kUsed) >> 5 |
                        (state[-1] & kUsed) >> 4 | (state[1] & kUsed) >> 3 | (below[-1] & kUsed) >> 2 |
                        (below[0] & kUsed) >> 1 | (below[1] & kUsed);
  return used ^ 0xffU;
}

}  // namespace

Region grow(LevelLineField& field, Pixel seed, Tolerance tolerance, std::span<Pixel> storage) {
  // Plain pointers: the compiler must not fear that a write to the states changes where the arrays are.
  std::uint8_t* const states = field.state.data();
  const Direction* const directions = field.direction.data();
  Pixel* const pixels = storage.data();
  const std::ptrdiff_t stride = field.stride;
  const std::int64_t tangent_q15 = tolerance.tangent_q15;
  struct Step {
    std::ptrdiff_t entries;
    std::uint32_t packed;
  };
  Step steps[8];
  for (std::size_t i = 0; i < 8; ++i)
    steps[i] = {kDown[i] * stride + kRight[i], packed({kRight[i], kDown[i]})};
  const std::size_t first = field.index(seed.x, seed.y);
  std::size_t count = 1;
  std::int64_t sum_x = directions[first].x;
  std::int64_t sum_y = directions[first].y;
  pixels[0] = seed;
  states[first] = static_cast<std::uint8_t>((states[first] + 1) | kUsed);
  for (std::size_t next = 0; next < count; ++next) {
    const Pixel pixel = pixels[next];
    const std::uint32_t pixel_packed = packed(pixel);
    std::uint8_t* const here = states + field.index(pixel.x, pixel.y);
    const Direction* const direction_here = directions + (here - states);
    // Whether a neighbour is aligned cannot be foreseen, so nothing branches on it: it is written down, and
    // stays if it counts. There is room: it is in no region yet.
    for (unsigned open = open_neighbours(here, stride); open != 0; open &= open - 1) {
      const Step step = steps[std::countr_zero(open)];
      std::uint8_t* const state = here + step.entries;
      const Direction d = direction_here[step.entries];
      const std::int64_t dot = d.x * sum_x + d.y * sum_y;
      const std::int64_t cross = d.x * sum_y - d.y * sum_x;
      const int aligned = (cross < 0 ? -cross : cross) * 32768 <= tangent_q15 * dot ? 1 : 0;
      pixels[count] = unpacked(pixel_packed + step.packed);
      count += static_cast<std::size_t>(aligned);
      *state = static_cast<std::uint8_t>(*state + aligned * (kUsed + 1));
      sum_x += d.x & -aligned;
      sum_y += d.y & -aligned;
    }
  }
  return {storage.first(count), sum_x, sum_y};
}

void release(LevelLineField& field, std::span<const Pixel> pixels) {
  for (const Pixel& pixel : pixels) {
    std::uint8_t& state = field.state[field.index(pixel.x, pixel.y)];
    if ((state & kGrowthsMask) < kMaxGrowths) state &= kGrowthsMask;
  }
}

}  // namespace plvo::lsd
