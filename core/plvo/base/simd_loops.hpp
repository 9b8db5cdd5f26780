// SPDX-License-Identifier: Apache-2.0
// The SIMD vectors and operations of base/simd.hpp as loops over plain arrays, for size-optimised code and as
// a reference for tests. Each element is computed by itself and wraps at its size. An expression of several
// operations is one loop: assigning it to a vector evaluates it element by element.
#pragma once

#include <algorithm>
#include <cstdint>

namespace plvo::simd_loops {

template <typename Number_, int kCount_, typename At>
struct SimdExpression {
  using Number = Number_;
  static constexpr int kCount = kCount_;
  At at;
  __attribute__((always_inline)) constexpr Number operator[](int i) const {
    return static_cast<Number>(at(i));
  }
};

template <typename Number_, int kCount_>
struct SimdLoop {
  using Number = Number_;
  static constexpr int kCount = kCount_;
  Number elements[kCount];

  SimdLoop() = default;
  template <typename... Numbers>
  requires(sizeof...(Numbers) == kCount) constexpr SimdLoop(Numbers... numbers)
      : elements{static_cast<Number>(numbers)...} {}
  template <typename At>
  __attribute__((always_inline)) constexpr SimdLoop(const SimdExpression<Number, kCount, At>& expression) {
    for (int i = 0; i < kCount; ++i) elements[i] = expression[i];
  }
  constexpr Number& operator[](int i) { return elements[i]; }
  constexpr const Number& operator[](int i) const { return elements[i]; }
  template <typename Int16x8>
  __attribute__((always_inline)) constexpr void operator+=(const Int16x8& b) {
    for (int i = 0; i < kCount; ++i) elements[i] = static_cast<Number>(elements[i] + b[i]);
  }
};

template <typename T>
concept SimdLike = requires(const T& x) {
  T::kCount;
  typename T::Number;
  x[0];
};

// The operands must live until the expression is assigned to a vector. Within one expression they do.
template <SimdLike A, typename At>
__attribute__((always_inline)) constexpr SimdExpression<typename A::Number, A::kCount, At> each(At at) {
  return {at};
}

template <SimdLike A, SimdLike B>
__attribute__((always_inline)) constexpr auto operator+(const A& a, const B& b) {
  return each<A>([&](int i) { return a[i] + b[i]; });
}
template <SimdLike A, SimdLike B>
__attribute__((always_inline)) constexpr auto operator-(const A& a, const B& b) {
  return each<A>([&](int i) { return a[i] - b[i]; });
}
template <SimdLike A, SimdLike B>
__attribute__((always_inline)) constexpr auto operator*(const A& a, const B& b) {
  return each<A>([&](int i) { return a[i] * b[i]; });
}
template <SimdLike A, SimdLike B>
__attribute__((always_inline)) constexpr auto operator&(const A& a, const B& b) {
  return each<A>([&](int i) { return a[i] & b[i]; });
}
template <SimdLike A>
__attribute__((always_inline)) constexpr auto operator+(const A& a, typename A::Number b) {
  return each<A>([&a, b](int i) { return a[i] + b; });
}
template <SimdLike A>
__attribute__((always_inline)) constexpr auto operator-(const A& a, typename A::Number b) {
  return each<A>([&a, b](int i) { return a[i] - b; });
}
template <SimdLike A>
__attribute__((always_inline)) constexpr auto operator*(const A& a, typename A::Number b) {
  return each<A>([&a, b](int i) { return a[i] * b; });
}
template <SimdLike A>
__attribute__((always_inline)) constexpr auto operator&(const A& a, typename A::Number b) {
  return each<A>([&a, b](int i) { return a[i] & b; });
}
template <SimdLike A>
__attribute__((always_inline)) constexpr auto operator>>(const A& a, int bits) {
  return each<A>([&a, bits](int i) { return a[i] >> bits; });
}
// Sets all bits of an element where the comparison holds, else none.
template <SimdLike A>
__attribute__((always_inline)) constexpr auto operator!=(const A& a, typename A::Number b) {
  return each<A>([&a, b](int i) { return a[i] != b ? -1 : 0; });
}

using Int16x8 = SimdLoop<std::int16_t, 8>;
using Int32x4 = SimdLoop<std::int32_t, 4>;

inline void load_bytes(const std::uint8_t* bytes, Int16x8& vector) {
  for (int i = 0; i < 8; ++i) vector[i] = bytes[i];
}

inline void load_bytes(const std::uint8_t* const places[4], Int16x8& first_two, Int16x8& others) {
  for (int i = 0; i < 8; ++i) first_two[i] = places[i / 4][i % 4];
  for (int i = 0; i < 8; ++i) others[i] = places[2 + i / 4][i % 4];
}

inline void load_halves(const std::int16_t* first, const std::int16_t* second, Int16x8& vector) {
  for (int i = 0; i < 8; ++i) vector[i] = i < 4 ? first[i] : second[i - 4];
}

inline void load(const std::int16_t* from, Int16x8& vector) {
  for (int i = 0; i < 8; ++i) vector[i] = from[i];
}

inline void store(const Int16x8& vector, std::int16_t* to) {
  for (int i = 0; i < 8; ++i) to[i] = vector[i];
}

inline void store(const Int32x4& vector, std::int32_t* to) {
  for (int i = 0; i < 4; ++i) to[i] = vector[i];
}

inline void store_bytes(const Int16x8& vector, std::uint8_t* to) {
  for (int i = 0; i < 8; ++i) to[i] = static_cast<std::uint8_t>(vector[i]);
}

inline void multiply_high(const Int16x8& a, const Int16x8& b, Int16x8& high) {
  for (int i = 0; i < 8; ++i) high[i] = static_cast<std::int16_t>((a[i] * b[i]) >> 16);
}

inline void add_halves(const Int16x8& a, const Int16x8& b, Int16x8& sums) {
  for (int i = 0; i < 4; ++i) {
    sums[i] = static_cast<std::int16_t>(a[i] + a[i + 4]);
    sums[i + 4] = static_cast<std::int16_t>(b[i] + b[i + 4]);
  }
}

inline void add_pairs(const Int32x4& a, const Int32x4& b, Int32x4& sums) {
  for (int i = 0; i < 2; ++i) {
    sums[i] = a[2 * i] + a[2 * i + 1];
    sums[i + 2] = b[2 * i] + b[2 * i + 1];
  }
}

inline void narrow(const Int32x4& first, const Int32x4& last, Int16x8& vector) {
  for (int i = 0; i < 8; ++i) vector[i] = static_cast<std::int16_t>(i < 4 ? first[i] : last[i - 4]);
}

inline void interleave(const Int16x8& a, const Int16x8& b, Int16x8& first, Int16x8& last) {
  for (int i = 0; i < 8; ++i) {
    first[i] = (i % 2 == 0 ? a : b)[i / 2];
    last[i] = (i % 2 == 0 ? a : b)[4 + i / 2];
  }
}

inline void dot_pairs(const Int16x8& a, const Int16x8& b, Int32x4& sums) {
  for (int i = 0; i < 4; ++i) sums[i] = a[2 * i] * b[2 * i] + a[2 * i + 1] * b[2 * i + 1];
}

inline void clamp(std::int16_t low, std::int16_t high, Int16x8& vector) {
  for (int i = 0; i < 8; ++i) vector[i] = std::clamp(vector[i], low, high);
}

inline void take_range(const Int32x4& value, Int32x4& low, Int32x4& high) {
  for (int i = 0; i < 4; ++i) {
    low[i] = std::min(low[i], value[i]);
    high[i] = std::max(high[i], value[i]);
  }
}

template <SimdLike A>
inline unsigned negative_mask(const A& vector) {
  unsigned bits = 0;
  for (int i = 0; i < A::kCount; ++i) bits |= (vector[i] < 0 ? 1U : 0U) << i;
  return bits;
}

}  // namespace plvo::simd_loops
