// SPDX-License-Identifier: Apache-2.0
// The numbers side by side of base/lanes.hpp and all that is done with them, as loops over plain arrays: for
// small code, and to compare with. Each lane by itself, wrapped to its size.
#pragma once

#include <algorithm>
#include <cstdint>

namespace plvo::lane_loops {

template <typename Number, int kCount>
struct LaneLoop {
  Number lane[kCount];

  constexpr Number& operator[](int i) { return lane[i]; }
  constexpr const Number& operator[](int i) const { return lane[i]; }
  constexpr void operator+=(const LaneLoop& b) { *this = *this + b; }

  template <typename Operation>
  constexpr LaneLoop each(const Operation& operation) const {
    LaneLoop result{};
    for (int i = 0; i < kCount; ++i) result[i] = static_cast<Number>(operation(lane[i], i));
    return result;
  }
  friend constexpr LaneLoop operator+(const LaneLoop& a, const LaneLoop& b) {
    return a.each([&](Number x, int i) { return x + b[i]; });
  }
  friend constexpr LaneLoop operator-(const LaneLoop& a, const LaneLoop& b) {
    return a.each([&](Number x, int i) { return x - b[i]; });
  }
  friend constexpr LaneLoop operator*(const LaneLoop& a, const LaneLoop& b) {
    return a.each([&](Number x, int i) { return x * b[i]; });
  }
  friend constexpr LaneLoop operator&(const LaneLoop& a, const LaneLoop& b) {
    return a.each([&](Number x, int i) { return x & b[i]; });
  }
  friend constexpr LaneLoop operator+(const LaneLoop& a, Number b) {
    return a.each([=](Number x, int) { return x + b; });
  }
  friend constexpr LaneLoop operator-(const LaneLoop& a, Number b) {
    return a.each([=](Number x, int) { return x - b; });
  }
  friend constexpr LaneLoop operator*(const LaneLoop& a, Number b) {
    return a.each([=](Number x, int) { return x * b; });
  }
  friend constexpr LaneLoop operator&(const LaneLoop& a, Number b) {
    return a.each([=](Number x, int) { return x & b; });
  }
  friend constexpr LaneLoop operator>>(const LaneLoop& a, int bits) {
    return a.each([=](Number x, int) { return x >> bits; });
  }
  // Every bit of a lane where it holds, or none.
  friend constexpr LaneLoop operator!=(const LaneLoop& a, Number b) {
    return a.each([=](Number x, int) { return x != b ? -1 : 0; });
  }
};
using Lanes = LaneLoop<std::int16_t, 8>;
using WideLanes = LaneLoop<std::int32_t, 4>;

inline void load_bytes(const std::uint8_t* bytes, Lanes& lanes) {
  for (int i = 0; i < 8; ++i) lanes[i] = bytes[i];
}

inline void load_bytes(const std::uint8_t* first, const std::uint8_t* second, Lanes& lanes) {
  for (int i = 0; i < 8; ++i) lanes[i] = i < 4 ? first[i] : second[i - 4];
}

inline void load_halves(const std::int16_t* first, const std::int16_t* second, Lanes& lanes) {
  for (int i = 0; i < 8; ++i) lanes[i] = i < 4 ? first[i] : second[i - 4];
}

inline void load(const std::int16_t* from, Lanes& lanes) {
  for (int i = 0; i < 8; ++i) lanes[i] = from[i];
}

inline void store(const Lanes& lanes, std::int16_t* to) {
  for (int i = 0; i < 8; ++i) to[i] = lanes[i];
}

inline void store(const WideLanes& lanes, std::int32_t* to) {
  for (int i = 0; i < 4; ++i) to[i] = lanes[i];
}

inline void store_wide(const Lanes& lanes, std::int32_t* out) {
  for (int i = 0; i < 8; ++i) out[i] = lanes[i];
}

inline void dot_pairs(const Lanes& a, const Lanes& b, WideLanes& sums) {
  for (int i = 0; i < 4; ++i) sums[i] = a[2 * i] * b[2 * i] + a[2 * i + 1] * b[2 * i + 1];
}

inline void take_range(const WideLanes& value, WideLanes& low, WideLanes& high) {
  for (int i = 0; i < 4; ++i) {
    low[i] = std::min(low[i], value[i]);
    high[i] = std::max(high[i], value[i]);
  }
}

}  // namespace plvo::lane_loops
