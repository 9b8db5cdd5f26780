// SPDX-License-Identifier: Apache-2.0
// Tests and sums of angles, eight pixels at once. They serve to grow a region and to count a rectangle's
// aligned pixels.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/base/bits.hpp"
#include "plvo/base/build.hpp"
#include "plvo/base/simd.hpp"
#include "plvo/lines/lsd/level_line_field.hpp"

namespace plvo::lsd {

// Number of set bits of a byte. Not every processor has an instruction for it.
inline constexpr auto kOnes = [] {
  std::array<std::uint8_t, 256> ones{};
  for (unsigned i = 0; i < 256; ++i) ones[i] = static_cast<std::uint8_t>(count_bits(i));
  return ones;
}();

// Sets all bits of element i if bit i is set.
inline Int16x8 chosen(unsigned bits) {
  return ((Int16x8{} + static_cast<std::int16_t>(bits)) & Int16x8{1, 2, 4, 8, 16, 32, 64, 128}) != 0;
}

class AngleRange {
 public:
  // tolerance: less than half a turn.
  AngleRange(Angle middle, Angle tolerance)
      : least_(static_cast<Angle>(middle - tolerance)),
        beyond_(static_cast<std::uint16_t>(2 * tolerance + 1)) {
#ifndef PLVO_SIMD_LOOPS
    // SIMD elements are signed, so the range is shifted to begin at the least 16-bit number.
    origins_ = Int16x8{} + static_cast<Angle>(least_ - INT16_MIN);
    ends_ = Int16x8{} + static_cast<Angle>(INT16_MIN + beyond_);
#endif
  }
  bool holds(Angle angle) const { return static_cast<std::uint16_t>(angle - least_) < beyond_; }
  // Bit i is set if the angle eight[i] is in the range.
  unsigned holding(const Angle* eight) const {
#ifdef PLVO_SIMD_LOOPS
    unsigned held = 0;
    for (int i = kBlockPixels - 1; i >= 0; --i) held = held << 1 | (holds(eight[i]) ? 1U : 0U);
    return held;
#else
    Int16x8 angles;
    load(eight, angles);
    const Int16x8 from_least = angles - origins_;
    const Int16x8 held = from_least < ends_;
    return negative_mask(held);
#endif
  }

 private:
  Angle least_;
  std::uint16_t beyond_;
#ifndef PLVO_SIMD_LOOPS
  Int16x8 origins_, ends_;
#endif
};

// Sums the differences between pixels' angles and a given angle.
class AngleSum {
 public:
  explicit AngleSum(Angle from) : from_(from) {}
  // Adds those of eight pixels whose bit is set.
  void add(const Angle* eight, unsigned bits) {
    if constexpr (kSimdLoops) {
      for (unsigned rest = bits; rest != 0; rest &= rest - 1)
        minus_[0] -= static_cast<Angle>(eight[lowest_bit(rest)] - from_);
      return;
    }
    Int16x8 angles;
    load(eight, angles);
    const Int16x8 beyond = angles - from_;
    Int32x4 pairs;
    dot_pairs(beyond, chosen(bits), pairs);  // a chosen element is −1
    minus_ += pairs;
  }
  std::int32_t beyond() const { return -(minus_[0] + minus_[1] + minus_[2] + minus_[3]); }

 private:
  Angle from_;
  Int32x4 minus_{};
};

// Sum of the squared differences, over the pixels whose bit is set.
inline std::int64_t squares_beyond(Angle from, const Angle* eight, unsigned bits) {
  if constexpr (kSimdLoops) {
    std::int64_t sum = 0;
    for (unsigned rest = bits; rest != 0; rest &= rest - 1) {
      const auto beyond = static_cast<Angle>(eight[lowest_bit(rest)] - from);
      sum += std::int64_t{beyond} * beyond;
    }
    return sum;
  }
  Int16x8 angles;
  load(eight, angles);
  const Int16x8 beyond = (angles - from) & chosen(bits);
  Int32x4 pairs;
  dot_pairs(beyond, beyond, pairs);
  // The sum for two half turns is 2^31, which needs an unsigned number.
  const auto sum_of = [&](int i) { return std::int64_t{static_cast<std::uint32_t>(pairs[i])}; };
  return sum_of(0) + sum_of(1) + sum_of(2) + sum_of(3);
}

}  // namespace plvo::lsd
