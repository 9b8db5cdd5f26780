// SPDX-License-Identifier: Apache-2.0
// SIMD vectors of eight 16-bit and four 32-bit integers, in the vector types of GCC and Clang. Each uses one
// register where the processor has one; the results are the same everywhere. Pass them by reference or to
// inlined functions, because the calling convention for vectors differs between processors. Loads from
// several addresses are combined in registers: a wide load right after narrower stores would stall.
// Processors without SIMD registers and size-optimised code use loops instead (base/simd_loops.hpp,
// base/build.hpp).
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "plvo/base/build.hpp"
#include "plvo/base/simd_loops.hpp"

namespace plvo {

// Sixteen bytes. This type has no replacement by loops.
using Bytes = std::uint8_t __attribute__((vector_size(16)));

// Interleaves the first eight bytes of a and b.
inline __attribute__((always_inline)) Bytes in_turns(const Bytes& a, const Bytes& b) {
  return __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
}

// Returns a mask whose bit i is set if byte i is 0xff. Each of the eight bytes must be 0x00 or 0xff.
inline __attribute__((always_inline)) unsigned gather_bytes(std::uint64_t eight) {
  // Byte i keeps its bit i. The highest byte of the product is the sum of all bytes.
  static_assert(std::endian::native == std::endian::little);
  return static_cast<unsigned>((eight & 0x8040201008040201U) * 0x0101010101010101U >> 56);
}

// The same for sixteen bytes.
inline __attribute__((always_inline)) unsigned set_bytes(const Bytes& bytes) {
#ifdef __SSE2__
  using Signed = char __attribute__((vector_size(16)));
  return static_cast<unsigned>(__builtin_ia32_pmovmskb128(reinterpret_cast<Signed>(bytes)));
#else
  std::uint64_t halves[2];
  std::memcpy(halves, &bytes, sizeof halves);
  return gather_bytes(halves[0]) | gather_bytes(halves[1]) << 8;
#endif
}

#ifdef PLVO_SIMD_LOOPS

using simd_loops::Int16x8;
using simd_loops::Int32x4;

#else

using Int16x8 = std::int16_t __attribute__((vector_size(16)));
using Int32x4 = std::int32_t __attribute__((vector_size(16)));

// Widens eight bytes to 16 bits each.
inline __attribute__((always_inline)) void widen_bytes(std::uint64_t bytes, Int16x8& vector) {
  // Interleaves the bytes with zeros: one instruction. GCC 12 compiles a plain conversion to five, or
  // converts byte by byte.
  static_assert(std::endian::native == std::endian::little);
  using Words = std::uint64_t __attribute__((vector_size(16)));
  const Words words = {bytes, 0};
  Bytes eight;
  std::memcpy(&eight, &words, sizeof eight);
  const Bytes wide = in_turns(eight, Bytes{});
  std::memcpy(&vector, &wide, sizeof vector);
}

// Loads eight bytes and widens them to 16 bits each.
inline __attribute__((always_inline)) void load_bytes(const std::uint8_t* bytes, Int16x8& vector) {
  std::uint64_t eight;
  std::memcpy(&eight, bytes, sizeof eight);
  widen_bytes(eight, vector);
}

// Loads four bytes from each of four addresses into one 32-bit element each.
inline __attribute__((always_inline)) void load_words(const std::uint8_t* const places[4], Int32x4& words) {
  std::int32_t four[4];
  for (int i = 0; i < 4; ++i) std::memcpy(&four[i], places[i], sizeof four[i]);
  words = Int32x4{four[0], four[1], four[2], four[3]};
}

// Loads four bytes from each of four addresses and widens them: the first two addresses into first_two, the
// last two into others.
inline __attribute__((always_inline)) void load_bytes(const std::uint8_t* const places[4], Int16x8& first_two,
                                                      Int16x8& others) {
  Int32x4 words;
  load_words(places, words);
  Bytes bytes;
  std::memcpy(&bytes, &words, sizeof bytes);
  const Bytes low = in_turns(bytes, Bytes{});
  const Bytes high =
      __builtin_shufflevector(bytes, Bytes{}, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
  std::memcpy(&first_two, &low, sizeof first_two);
  std::memcpy(&others, &high, sizeof others);
}

// Loads four numbers from each of two addresses.
inline __attribute__((always_inline)) void load_halves(const std::int16_t* first, const std::int16_t* second,
                                                       Int16x8& vector) {
  using Words = std::uint64_t __attribute__((vector_size(16)));
  std::uint64_t four[2];
  std::memcpy(&four[0], first, sizeof four[0]);
  std::memcpy(&four[1], second, sizeof four[1]);
  const Words words = {four[0], four[1]};
  std::memcpy(&vector, &words, sizeof vector);
}

inline __attribute__((always_inline)) void load(const std::int16_t* from, Int16x8& vector) {
  std::memcpy(&vector, from, sizeof vector);
}

inline __attribute__((always_inline)) void store(const Int16x8& vector, std::int16_t* to) {
  std::memcpy(to, &vector, sizeof vector);
}

inline __attribute__((always_inline)) void store(const Int32x4& vector, std::int32_t* to) {
  std::memcpy(to, &vector, sizeof vector);
}

// Stores the vector as eight bytes. Each value must lie in 0 … 255.
inline __attribute__((always_inline)) void store_bytes(const Int16x8& vector, std::uint8_t* to) {
#ifdef __SSE2__
  const auto packed = __builtin_ia32_packuswb128(vector, vector);
  std::memcpy(to, &packed, 8);
#else
  using EightBytes = std::uint8_t __attribute__((vector_size(8)));
  const EightBytes eight = __builtin_convertvector(vector, EightBytes);
  std::memcpy(to, &eight, sizeof eight);
#endif
}

// Per element: low = min(low, value), high = max(high, value).
inline __attribute__((always_inline)) void take_range(const Int32x4& value, Int32x4& low, Int32x4& high) {
  low = value < low ? value : low;
  high = value > high ? value : high;
}

// Per element: limits the value to low … high.
inline __attribute__((always_inline)) void clamp(std::int16_t low, std::int16_t high, Int16x8& vector) {
  const Int16x8 least = Int16x8{} + low;
  const Int16x8 most = Int16x8{} + high;
  vector = vector < least ? least : vector;
  vector = vector > most ? most : vector;
}

// Per element: a · b / 2^16, rounded down.
inline __attribute__((always_inline)) void multiply_high(const Int16x8& a, const Int16x8& b, Int16x8& high) {
#ifdef __SSE2__
  high = __builtin_ia32_pmulhw128(a, b);
#else
  using EightWide = std::int32_t __attribute__((vector_size(32)));
  const EightWide products = __builtin_convertvector(a, EightWide) * __builtin_convertvector(b, EightWide);
  high = __builtin_convertvector(products >> 16, Int16x8);
#endif
}

// Adds the elements that are four apart: four sums of a, then four sums of b.
inline __attribute__((always_inline)) void add_halves(const Int16x8& a, const Int16x8& b, Int16x8& sums) {
  sums = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11) +
         __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
}

// Adds adjacent elements: two sums of a, then two sums of b.
inline __attribute__((always_inline)) void add_pairs(const Int32x4& a, const Int32x4& b, Int32x4& sums) {
  sums = __builtin_shufflevector(a, b, 0, 2, 4, 6) + __builtin_shufflevector(a, b, 1, 3, 5, 7);
}

// Joins two vectors of 32-bit values into one. The values must fit in 16 bits.
inline __attribute__((always_inline)) void narrow(const Int32x4& first, const Int32x4& last,
                                                  Int16x8& vector) {
#ifdef __SSE2__
  vector = __builtin_ia32_packssdw128(first, last);
#else
  Int16x8 low, high;
  std::memcpy(&low, &first, sizeof low);
  std::memcpy(&high, &last, sizeof high);
  static_assert(std::endian::native == std::endian::little);
  vector = __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
#endif
}

// Interleaves a and b: first = a[0], b[0], a[1] … b[3]; last holds the rest.
inline __attribute__((always_inline)) void interleave(const Int16x8& a, const Int16x8& b, Int16x8& first,
                                                      Int16x8& last) {
  first = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
  last = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
}

// sums[i] = a[2i] b[2i] + a[2i + 1] b[2i + 1]. Each sum must fit in 32 bits.
inline __attribute__((always_inline)) void dot_pairs(const Int16x8& a, const Int16x8& b, Int32x4& sums) {
#ifdef __SSE2__
  sums = __builtin_ia32_pmaddwd128(a, b);
#else
  // A 32-bit element holds two values; the first is the lower half.
  static_assert(std::endian::native == std::endian::little);
  Int32x4 both_a, both_b;
  std::memcpy(&both_a, &a, sizeof both_a);
  std::memcpy(&both_b, &b, sizeof both_b);
  sums = ((both_a << 16) >> 16) * ((both_b << 16) >> 16) + (both_a >> 16) * (both_b >> 16);
#endif
}

// Returns a mask whose bit i is set if element i is negative.
inline __attribute__((always_inline)) unsigned negative_mask(const Int16x8& vector) {
#ifdef __SSE2__
  const auto packed = __builtin_ia32_packsswb128(vector, vector);
  return static_cast<unsigned>(__builtin_ia32_pmovmskb128(packed)) & 0xffU;
#else
  using EightBytes = std::int8_t __attribute__((vector_size(8)));
  const EightBytes bytes = __builtin_convertvector(vector >> 15, EightBytes);
  std::uint64_t eight;
  std::memcpy(&eight, &bytes, sizeof eight);
  return gather_bytes(eight);
#endif
}

inline __attribute__((always_inline)) unsigned negative_mask(const Int32x4& vector) {
#ifdef __SSE2__
  using Floats = float __attribute__((vector_size(16)));
  Floats same;
  std::memcpy(&same, &vector, sizeof same);
  return static_cast<unsigned>(__builtin_ia32_movmskps(same));
#else
  const Int32x4 bits = (vector >> 31) & Int32x4{1, 2, 4, 8};
  return static_cast<unsigned>(bits[0] | bits[1] | bits[2] | bits[3]);
#endif
}

#endif

}  // namespace plvo
