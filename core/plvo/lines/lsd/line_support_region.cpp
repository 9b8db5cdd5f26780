// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/line_support_region.hpp"

#include <bit>

#include "plvo/base/build.hpp"
#include "plvo/lines/lsd/wedge.hpp"

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

// Which of a pixel's neighbours are in a wedge, bit by bit.
#ifdef PLVO_LANE_LOOPS
class Sides {
 public:
  void set(const Wedge& wedge) { wedge_ = wedge; }
  // Of those in no region yet, bit by bit.
  unsigned open(const std::uint8_t* state, const Direction* here, std::ptrdiff_t stride) const {
    unsigned held = 0;
    for (int i = 7; i >= 0; --i) {
      const std::ptrdiff_t at = kDown[i] * stride + kRight[i];
      held = held << 1 | static_cast<unsigned>((state[at] & kUsed) == 0 && wedge_.holds(here[at]));
    }
    return held;
  }

 private:
  Wedge wedge_{};
};
#else
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

// Rows of four directions, of which one is looked past: the one behind the neighbours, and in the last row,
// behind which there may be none, the one before them. The field's directions stay as they are, so wide loads
// wait for nobody.
class Sides {
 public:
  void set(const Wedge& wedge) { wedge_ = WedgeLanes(wedge); }
  unsigned open(const std::uint8_t* state, const Direction* here, std::ptrdiff_t stride) const {
    return open_neighbours(state, stride) & holding(here, stride);
  }

 private:
  unsigned holding(const Direction* here, std::ptrdiff_t stride) const {
    const unsigned above = wedge_.holding(here - stride - 1);
    const unsigned beside = wedge_.holding(here - 1);
    const unsigned below = wedge_.holding(here + stride - 2);
    return (above & 7U) | (beside & 1U) << 3 | (beside & 4U) << 2 | (below & 14U) << 4;
  }

  WedgeLanes wedge_;
};
#endif

}  // namespace

Region grow(LevelLineField& field, Pixel seed, Tolerance tolerance, std::span<Pixel> storage) {
  // Plain pointers: the compiler must not fear that a write to the states changes where the arrays are.
  std::uint8_t* const states = field.state.data();
  const Direction* const directions = field.direction.data();
  Pixel* const pixels = storage.data();
  const std::ptrdiff_t stride = field.stride;
  struct Step {
    std::ptrdiff_t entries;
    std::uint32_t packed;
    std::ptrdiff_t beyond;
  };
  Step steps[8];
  for (std::size_t i = 0; i < 8; ++i)
    steps[i] = {kDown[i] * stride + kRight[i], packed({kRight[i], kDown[i]}), kDown[i] * stride};
  const std::size_t first = field.index(seed.x, seed.y);
  std::size_t count = 1;
  std::size_t renew = 1;
  Sides sides;
  std::int64_t sum_x = directions[first].x;
  std::int64_t sum_y = directions[first].y;
  pixels[0] = seed;
  states[first] = static_cast<std::uint8_t>((states[first] + 1) | kUsed);
  for (std::size_t next = 0; next < count; ++next) {
    // Not for every pixel: the tests of the next would wait for all that this one adds.
    if (count >= renew) {
      sides.set(make_wedge(sum_x, sum_y, tolerance));
      renew = count + count / 8 + 1;
    }
    const Pixel pixel = pixels[next];
    const std::uint32_t pixel_packed = packed(pixel);
    std::uint8_t* const here = states + field.index(pixel.x, pixel.y);
    const Direction* const direction_here = directions + (here - states);
    for (unsigned taken = sides.open(here, direction_here, stride); taken != 0; taken &= taken - 1) {
      const Step step = steps[std::countr_zero(taken)];
      std::uint8_t& state = here[step.entries];
      const Direction d = direction_here[step.entries];
      pixels[count++] = unpacked(pixel_packed + step.packed);
      state = static_cast<std::uint8_t>((state + 1) | kUsed);
      sum_x += d.x;
      sum_y += d.y;
      if constexpr (!kSmallCode) {
        // Its turn comes soon, and the row beyond it has not been looked at yet.
        __builtin_prefetch(&state + step.beyond);
        __builtin_prefetch(direction_here + step.entries + step.beyond);
      }
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
