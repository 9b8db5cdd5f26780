// SPDX-License-Identifier: Apache-2.0
// The numbers side by side of base/lanes.hpp and all that is done with them, as loops over plain arrays: for
// small code, and to compare with. Each lane by itself, wrapped to its size. What is computed of several is
// one loop: an expression is worked out, lane after lane, when it is put into lanes.
#pragma once

#include <algorithm>
#include <cstdint>

namespace plvo::lane_loops {

template <typename Number_, int kCount_, typename At>
struct LaneExpression {
  using Number = Number_;
  static constexpr int kCount = kCount_;
  At at;
  __attribute__((always_inline)) constexpr Number operator[](int i) const {
    return static_cast<Number>(at(i));
  }
};

template <typename Number_, int kCount_>
struct LaneLoop {
  using Number = Number_;
  static constexpr int kCount = kCount_;
  Number lane[kCount];

  LaneLoop() = default;
  template <typename... Numbers>
  requires(sizeof...(Numbers) == kCount) constexpr LaneLoop(Numbers... numbers)
      : lane{static_cast<Number>(numbers)...} {}
  template <typename At>
  __attribute__((always_inline)) constexpr LaneLoop(const LaneExpression<Number, kCount, At>& expression) {
    for (int i = 0; i < kCount; ++i) lane[i] = expression[i];
  }
  constexpr Number& operator[](int i) { return lane[i]; }
  constexpr const Number& operator[](int i) const { return lane[i]; }
  template <typename Lanes>
  __attribute__((always_inline)) constexpr void operator+=(const Lanes& b) {
    for (int i = 0; i < kCount; ++i) lane[i] = static_cast<Number>(lane[i] + b[i]);
  }
};

template <typename T>
concept Laned = requires(const T& x) {
  T::kCount;
  typename T::Number;
  x[0];
};

// Its operands must live until it is put into lanes: within one expression they do.
template <Laned A, typename At>
__attribute__((always_inline)) constexpr LaneExpression<typename A::Number, A::kCount, At> each(At at) {
  return {at};
}

template <Laned A, Laned B>
__attribute__((always_inline)) constexpr auto operator+(const A& a, const B& b) {
  return each<A>([&](int i) { return a[i] + b[i]; });
}
template <Laned A, Laned B>
__attribute__((always_inline)) constexpr auto operator-(const A& a, const B& b) {
  return each<A>([&](int i) { return a[i] - b[i]; });
}
template <Laned A, Laned B>
__attribute__((always_inline)) constexpr auto operator*(const A& a, const B& b) {
  return each<A>([&](int i) { return a[i] * b[i]; });
}
template <Laned A, Laned B>
__attribute__((always_inline)) constexpr auto operator&(const A& a, const B& b) {
  return each<A>([&](int i) { return a[i] & b[i]; });
}
template <Laned A>
__attribute__((always_inline)) constexpr auto operator+(const A& a, typename A::Number b) {
  return each<A>([&a, b](int i) { return a[i] + b; });
}
template <Laned A>
__attribute__((always_inline)) constexpr auto operator-(const A& a, typename A::Number b) {
  return each<A>([&a, b](int i) { return a[i] - b; });
}
template <Laned A>
__attribute__((always_inline)) constexpr auto operator*(const A& a, typename A::Number b) {
  return each<A>([&a, b](int i) { return a[i] * b; });
}
template <Laned A>
__attribute__((always_inline)) constexpr auto operator&(const A& a, typename A::Number b) {
  return each<A>([&a, b](int i) { return a[i] & b; });
}
template <Laned A>
__attribute__((always_inline)) constexpr auto operator>>(const A& a, int bits) {
  return each<A>([&a, bits](int i) { return a[i] >> bits; });
}
// Every bit of a lane where it holds, or none.
template <Laned A>
__attribute__((always_inline)) constexpr auto operator!=(const A& a, typename A::Number b) {
  return each<A>([&a, b](int i) { return a[i] != b ? -1 : 0; });
}

using Lanes = LaneLoop<std::int16_t, 8>;
using WideLanes = LaneLoop<std::int32_t, 4>;

inline void load_bytes(const std::uint8_t* bytes, Lanes& lanes) {
  for (int i = 0; i < 8; ++i) lanes[i] = bytes[i];
}

inline void load_bytes(const std::uint8_t* const places[4], Lanes& first_two, Lanes& others) {
  for (int i = 0; i < 8; ++i) first_two[i] = places[i / 4][i % 4];
  for (int i = 0; i < 8; ++i) others[i] = places[2 + i / 4][i % 4];
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

inline void store_bytes(const Lanes& lanes, std::uint8_t* to) {
  for (int i = 0; i < 8; ++i) to[i] = static_cast<std::uint8_t>(lanes[i]);
}

inline void multiply_high(const Lanes& a, const Lanes& b, Lanes& high) {
  for (int i = 0; i < 8; ++i) high[i] = static_cast<std::int16_t>((a[i] * b[i]) >> 16);
}

inline void add_halves(const Lanes& a, const Lanes& b, Lanes& sums) {
  for (int i = 0; i < 4; ++i) {
    sums[i] = static_cast<std::int16_t>(a[i] + a[i + 4]);
    sums[i + 4] = static_cast<std::int16_t>(b[i] + b[i + 4]);
  }
}

inline void add_pairs(const WideLanes& a, const WideLanes& b, WideLanes& sums) {
  for (int i = 0; i < 2; ++i) {
    sums[i] = a[2 * i] + a[2 * i + 1];
    sums[i + 2] = b[2 * i] + b[2 * i + 1];
  }
}

inline void narrow(const WideLanes& first, const WideLanes& last, Lanes& lanes) {
  for (int i = 0; i < 8; ++i) lanes[i] = static_cast<std::int16_t>(i < 4 ? first[i] : last[i - 4]);
}

inline void interleave(const Lanes& a, const Lanes& b, Lanes& first, Lanes& last) {
  for (int i = 0; i < 8; ++i) {
    first[i] = (i % 2 == 0 ? a : b)[i / 2];
    last[i] = (i % 2 == 0 ? a : b)[4 + i / 2];
  }
}

inline void dot_pairs(const Lanes& a, const Lanes& b, WideLanes& sums) {
  for (int i = 0; i < 4; ++i) sums[i] = a[2 * i] * b[2 * i] + a[2 * i + 1] * b[2 * i + 1];
}

inline void clamp(std::int16_t low, std::int16_t high, Lanes& lanes) {
  for (int i = 0; i < 8; ++i) lanes[i] = std::clamp(lanes[i], low, high);
}

inline void take_range(const WideLanes& value, WideLanes& low, WideLanes& high) {
  for (int i = 0; i < 4; ++i) {
    low[i] = std::min(low[i], value[i]);
    high[i] = std::max(high[i], value[i]);
  }
}

template <Laned A>
inline unsigned negative_lanes(const A& lanes) {
  unsigned bits = 0;
  for (int i = 0; i < A::kCount; ++i) bits |= (lanes[i] < 0 ? 1U : 0U) << i;
  return bits;
}

}  // namespace plvo::lane_loops
