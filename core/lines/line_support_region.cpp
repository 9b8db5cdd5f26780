// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/line_support_region.hpp"

namespace plvo::lsd {

Region grow(LevelLineField& field, Pixel seed, Tolerance tolerance, std::span<Pixel> storage) {
  constexpr int kNeighbours[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}};
  std::size_t count = 0;
  std::int64_t sum_x = 0;
  std::int64_t sum_y = 0;
  const auto add = [&](std::size_t i, int x, int y) {
    field.state[i] = static_cast<std::uint8_t>((field.state[i] + 1) | kUsed);
    storage[count++] = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
    sum_x += field.direction[i].x;
    sum_y += field.direction[i].y;
  };
  add(field.index(seed.x, seed.y), seed.x, seed.y);
  for (std::size_t next = 0; next < count; ++next) {
    const Pixel centre = storage[next];
    for (const auto& step : kNeighbours) {
      const int x = centre.x + step[0];
      const int y = centre.y + step[1];
      const std::size_t i = field.index(x, y);
      if ((field.state[i] & kUsed) != 0) continue;
      const Direction d = field.direction[i];
      const std::int64_t dot = d.x * sum_x + d.y * sum_y;
      const std::int64_t cross = d.x * sum_y - d.y * sum_x;
      if ((cross < 0 ? -cross : cross) * 32768 <= tolerance.tangent_q15 * dot) add(i, x, y);
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
