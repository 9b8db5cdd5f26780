// SPDX-License-Identifier: Apache-2.0
// Patterns of missing depth: combs, as of a coarser depth camera that is registered to colour, and random
// grids.
#pragma once

#include <array>
#include <cstdint>

namespace plvo::test {

struct HolePattern {
  const char* name;
  bool (*missing)(int x, int y);
};

// Whether one of `percent` in a hundred pixels falls on (x, y), by a hash of the position.
inline bool one_of_hundred(int x, int y, unsigned percent) {
  std::uint64_t hash = static_cast<std::uint64_t>(y) * 0x9e3779b97f4a7c15 + static_cast<std::uint64_t>(x);
  for (int i = 0; i < 2; ++i) hash = (hash ^ hash >> 31) * 0xbf58476d1ce4e5b9;
  return (hash >> 32) % 100 < percent;
}

inline constexpr std::array kHolePatterns = {
    HolePattern{"every second row and column", [](int x, int y) { return x % 2 == 0 || y % 2 == 0; }},
    HolePattern{"every third row and column", [](int x, int y) { return x % 3 == 0 || y % 3 == 0; }},
    HolePattern{"all but every third row and column", [](int x, int y) { return x % 3 != 1 || y % 3 != 1; }},
    HolePattern{"every second row", [](int, int y) { return y % 2 == 0; }},
    HolePattern{"64 % in a grid", [](int x, int y) { return 3 * x % 5 >= 3 || 3 * y % 5 >= 3; }},
    HolePattern{"36 % at random", [](int x, int y) { return one_of_hundred(x, y, 36); }},
    HolePattern{"64 % at random", [](int x, int y) { return one_of_hundred(x, y, 64); }},
};

}  // namespace plvo::test
