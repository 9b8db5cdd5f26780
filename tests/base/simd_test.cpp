// SPDX-License-Identifier: Apache-2.0
// Compares the SIMD vectors with the loops that replace them in size-optimised code.
#include "plvo/base/simd.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

using Eight = std::array<std::int16_t, 8>;

// Numbers of the whole range, so that sums and products wrap.
Eight any_numbers(Random& random) {
  Eight numbers{};
  for (std::int16_t& number : numbers) number = static_cast<std::int16_t>(random.below(1 << 16));
  return numbers;
}

template <typename Numbers>
Numbers loaded(const Eight& numbers) {
  Numbers vector;
  load(numbers.data(), vector);
  return vector;
}

template <typename Numbers>
Eight stored(const Numbers& vector) {
  Eight numbers{};
  store(vector, numbers.data());
  return numbers;
}

// Applies `make` to the same numbers as SIMD vectors and as loops; the results must be equal.
template <typename Make>
void expect_alike(const Eight& a, const Eight& b, const Make& make) {
  using Slow = simd_loops::Int16x8;
  EXPECT_EQ(stored(make(loaded<Int16x8>(a), loaded<Int16x8>(b))),
            stored(make(loaded<Slow>(a), loaded<Slow>(b))));
}

TEST(Int16x8, ArithmeticEqualsThatOfLoops) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    const Eight a = any_numbers(random);
    Eight b = any_numbers(random);
    b[3] = a[3];
    const std::int16_t one = a[5];
    const int bits = static_cast<int>(random.below(15));
    expect_alike(a, b, []<typename T>(const T& x, const T& y) -> T { return x + y; });
    expect_alike(a, b, []<typename T>(const T& x, const T& y) -> T { return x - y; });
    expect_alike(a, b, []<typename T>(const T& x, const T& y) -> T { return x * y; });
    expect_alike(a, b, []<typename T>(const T& x, const T& y) -> T { return x & y; });
    expect_alike(a, b, [&]<typename T>(const T& x, const T&) -> T { return x + one; });
    expect_alike(a, b, [&]<typename T>(const T& x, const T&) -> T { return x - one; });
    expect_alike(a, b, [&]<typename T>(const T& x, const T&) -> T { return x * one; });
    const std::int16_t low = std::min(a[0], b[0]);
    const std::int16_t high = std::max(a[0], b[0]);
    const auto clamped = [&]<typename T>(const T& x, const T&) -> T {
      T vector = x;
      clamp(low, high, vector);
      return vector;
    };
    expect_alike(a, b, clamped);
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_EQ(stored(clamped(loaded<Int16x8>(a), loaded<Int16x8>(b)))[i], std::clamp(a[i], low, high));
    expect_alike(a, b, [&]<typename T>(const T& x, const T&) -> T { return x & one; });
    expect_alike(a, b, [&]<typename T>(const T& x, const T&) -> T { return x >> bits; });
    expect_alike(a, b, []<typename T>(const T& x, const T& y) -> T { return (x - y) != 0; });
  }
}

TEST(Int16x8, LoadsAndStoresEqualThoseOfLoops) {
  Random random(2);
  for (int round = 0; round < 200; ++round) {
    std::array<std::uint8_t, 16> bytes{};
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    const Eight a = any_numbers(random);
    const Eight b = any_numbers(random);
    Int16x8 fast;
    simd_loops::Int16x8 slow;
    load_bytes(&bytes[3], fast);
    load_bytes(&bytes[3], slow);
    EXPECT_EQ(stored(fast), stored(slow));
    const std::uint8_t* const places[4] = {&bytes[1], &bytes[12], &bytes[0], &bytes[5]};
    Int16x8 fast_others;
    simd_loops::Int16x8 slow_others;
    load_bytes(places, fast, fast_others);
    load_bytes(places, slow, slow_others);
    EXPECT_EQ(stored(fast), stored(slow));
    EXPECT_EQ(stored(fast_others), stored(slow_others));
    load_halves(&a[1], &b[4], fast);
    load_halves(&a[1], &b[4], slow);
    EXPECT_EQ(stored(fast), stored(slow));
    load_bytes(&bytes[6], fast);
    std::array<std::uint8_t, 8> written{};
    store_bytes(fast, written.data());
    EXPECT_TRUE(std::equal(written.begin(), written.end(), &bytes[6]));
    store_bytes(loaded<simd_loops::Int16x8>(stored(fast)), written.data());
    EXPECT_TRUE(std::equal(written.begin(), written.end(), &bytes[6]));
  }
}

TEST(Int16x8, InterleavingAddingAndNarrowingEqualThoseOfLoops) {
  Random random(4);
  for (int round = 0; round < 200; ++round) {
    const Eight a = any_numbers(random);
    const Eight b = any_numbers(random);
    Int16x8 fast, fast_others;
    simd_loops::Int16x8 slow, slow_others;
    add_halves(loaded<Int16x8>(a), loaded<Int16x8>(b), fast);
    add_halves(loaded<simd_loops::Int16x8>(a), loaded<simd_loops::Int16x8>(b), slow);
    EXPECT_EQ(stored(fast), stored(slow));
    interleave(loaded<Int16x8>(a), loaded<Int16x8>(b), fast, fast_others);
    interleave(loaded<simd_loops::Int16x8>(a), loaded<simd_loops::Int16x8>(b), slow, slow_others);
    EXPECT_EQ(stored(fast), stored(slow));
    EXPECT_EQ(stored(fast_others), stored(slow_others));
    // 32-bit numbers that fit 16 bits.
    const Int32x4 p = {a[0], a[1] / 2, a[2] / 2, a[3]}, q = {b[0], b[1], b[2], b[3]};
    const simd_loops::Int32x4 slow_p(a[0], a[1] / 2, a[2] / 2, a[3]), slow_q(b[0], b[1], b[2], b[3]);
    Int32x4 sums;
    simd_loops::Int32x4 slow_sums;
    add_pairs(p, q, sums);
    add_pairs(slow_p, slow_q, slow_sums);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(sums[i], slow_sums[i]);
    narrow(p, q, fast);
    narrow(slow_p, slow_q, slow);
    EXPECT_EQ(stored(fast), stored(slow));
  }
}

TEST(Int16x8, SetBytesGivesOneBitPerByte) {
  Random random(6);
  for (int round = 0; round < 200; ++round) {
    const std::uint32_t chosen = random.below(1 << 16);
    Bytes bytes = {};
    for (int i = 0; i < 16; ++i) bytes[i] = (chosen >> i & 1) != 0 ? 255 : 0;
    EXPECT_EQ(set_bytes(bytes), chosen);
  }
}

TEST(Int16x8, MultiplyHighEqualsThatOfLoops) {
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    const Eight a = any_numbers(random);
    const Eight b = any_numbers(random);
    Int16x8 fast;
    simd_loops::Int16x8 slow;
    multiply_high(loaded<Int16x8>(a), loaded<Int16x8>(b), fast);
    multiply_high(loaded<simd_loops::Int16x8>(a), loaded<simd_loops::Int16x8>(b), slow);
    EXPECT_EQ(stored(fast), stored(slow));
  }
}

TEST(Int16x8, DotPairsRangesAndSignsEqualThoseOfLoops) {
  Random random(3);
  Int32x4 low = {}, high = {};
  simd_loops::Int32x4 slow_low = {}, slow_high = {};
  for (int round = 0; round < 200; ++round) {
    // dot_pairs excludes −2^15 twice in both operands, whose sum exceeds 32 bits.
    Eight a = any_numbers(random);
    for (std::int16_t& number : a) number = static_cast<std::int16_t>(number / 2);
    const Eight b = any_numbers(random);
    Int32x4 sums;
    dot_pairs(loaded<Int16x8>(a), loaded<Int16x8>(b), sums);
    simd_loops::Int32x4 slow_sums;
    dot_pairs(loaded<simd_loops::Int16x8>(a), loaded<simd_loops::Int16x8>(b), slow_sums);
    take_range(sums, low, high);
    take_range(slow_sums, slow_low, slow_high);
    EXPECT_EQ(negative_mask(sums), negative_mask(slow_sums));
    EXPECT_EQ(negative_mask(loaded<Int16x8>(b)), negative_mask(loaded<simd_loops::Int16x8>(b)));
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(sums[i], slow_sums[i]);
      EXPECT_EQ(low[i], slow_low[i]);
      EXPECT_EQ(high[i], slow_high[i]);
    }
  }
  for (int i = 0; i < 4; ++i) EXPECT_LT(low[i], high[i]);
}

}  // namespace
}  // namespace plvo
