// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/line_support_region.hpp"

namespace plvo::lsd {

Region grow(LevelLineField& field, Pixel seed, Tolerance tolerance, std::span<Pixel> storage) {
  // Plain pointers: the compiler must not fear that a write to the states changes where the arrays are.
  std::uint8_t* const states = field.state.data();
  const Direction* const directions = field.direction.data();
  Pixel* const pixels = storage.data();
  const std::ptrdiff_t stride = field.stride;
  const std::int64_t tangent_q15 = tolerance.tangent_q15;
  std::size_t count = 0;
  std::int64_t sum_x = 0;
  std::int64_t sum_y = 0;
  const auto add = [&](std::uint8_t* state, int x, int y) {
    const Direction d = directions[state - states];
    *state = static_cast<std::uint8_t>((*state + 1) | kUsed);
    pixels[count++] = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
    sum_x += d.x;
    sum_y += d.y;
  };
  const auto try_add = [&](std::uint8_t* state, int x, int y) {
    if ((*state & kUsed) != 0) return;
    const Direction d = directions[state - states];
    const std::int64_t dot = d.x * sum_x + d.y * sum_y;
    const std::int64_t cross = d.x * sum_y - d.y * sum_x;
    if ((cross < 0 ? -cross : cross) * 32768 <= tangent_q15 * dot) add(state, x, y);
  };
  add(states + field.index(seed.x, seed.y), seed.x, seed.y);
  for (std::size_t next = 0; next < count; ++next) {
    const int x = pixels[next].x;
    const int y = pixels[next].y;
    std::uint8_t* row = states + field.index(x, y - 1);
    for (int j = y - 1; j <= y + 1; ++j, row += stride) {
      // Most neighbours are taken already: three at a glance.
      if ((row[-1] & row[0] & row[1] & kUsed) != 0) continue;
      try_add(row - 1, x - 1, j);
      try_add(row, x, j);
      try_add(row + 1, x + 1, j);
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
