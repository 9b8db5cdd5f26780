// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/smoothing.hpp"

#include <algorithm>

#include "plvo/base/build.hpp"
#include "plvo/base/simd.hpp"

namespace plvo {
namespace {

// The vertical pass writes one row of 16-bit sums, padded left and right; the horizontal pass then reads that
// row. Both inner loops run straight over contiguous memory, so compilers vectorise them. Integer arithmetic
// makes the result independent of the vectorisation.
void repeat_borders(std::uint16_t* row, int width, int pad) {
  for (int i = 1; i <= pad; ++i) {
    row[-i] = row[0];
    row[width - 1 + i] = row[width - 1];
  }
}

const std::uint8_t* clamped_row(GrayView image, int y) {
  return image.row(std::clamp(y, 0, image.height - 1));
}

// Weighted sum of s[0] and two values on either side.
std::uint8_t binomial5(const std::uint16_t* s) {
  const std::uint32_t sum = s[-2] + s[2] + 4u * (static_cast<std::uint32_t>(s[-1]) + s[1]) + 6u * s[0];
  return static_cast<std::uint8_t>((sum + 128) >> 8);
}

// Eight outputs at once, from sums of at most 16 · 255. Each element of a dot product weights two adjacent
// sums.
void binomial5_of_eight(const std::uint16_t* s, std::uint8_t* out) {
  constexpr Int16x8 kBefore = {1, 4, 1, 4, 1, 4, 1, 4}, kHere = {6, 4, 6, 4, 6, 4, 6, 4},
                    kAfter = {1, 0, 1, 0, 1, 0, 1, 0};
  Int32x4 sums[2];
  for (int half = 0; half < 2; ++half, s += 8) {
    const auto* const at = reinterpret_cast<const std::int16_t*>(s);
    Int16x8 two;
    Int32x4 before, here, after;
    load(at - 2, two);
    dot_pairs(two, kBefore, before);
    load(at, two);
    dot_pairs(two, kHere, here);
    load(at + 2, two);
    dot_pairs(two, kAfter, after);
    sums[half] = (before + here + after + 128) >> 8;
  }
  Int16x8 eight;
  narrow(sums[0], sums[1], eight);
  store_bytes(eight, out);
}

}  // namespace

void smooth_binomial7(GrayView in, ImageView<std::uint8_t> out, std::span<std::uint16_t> row_sums) {
  const int width = in.width;
  std::uint16_t* sums = row_sums.data() + 8;
  for (int y = 0; y < in.height; ++y) {
    const std::uint8_t* r0 = clamped_row(in, y - 3);
    const std::uint8_t* r1 = clamped_row(in, y - 2);
    const std::uint8_t* r2 = clamped_row(in, y - 1);
    const std::uint8_t* r3 = clamped_row(in, y);
    const std::uint8_t* r4 = clamped_row(in, y + 1);
    const std::uint8_t* r5 = clamped_row(in, y + 2);
    const std::uint8_t* r6 = clamped_row(in, y + 3);
    for (int x = 0; x < width; ++x) {
      const auto sum =
          static_cast<std::uint16_t>(r0[x] + r6[x] + 6 * (r1[x] + r5[x]) + 15 * (r2[x] + r4[x]) + 20 * r3[x]);
      sums[x] = static_cast<std::uint16_t>((sum + 8) >> 4);  // quarters of a grey level
    }
    repeat_borders(sums, width, 3);
    std::uint8_t* line = out.row(y);
    for (int x = 0; x < width; ++x) {
      const std::uint16_t* s = sums + x;
      const auto sum = static_cast<std::uint16_t>(s[-3] + s[3] + 6 * (s[-2] + s[2]) + 15 * (s[-1] + s[1]) +
                                                  20 * s[0] + 128);  // at most 64 · 1020 + 128
      line[x] = static_cast<std::uint8_t>(sum >> 8);
    }
  }
}

void halve_binomial5(GrayView in, ImageView<std::uint8_t> out, std::span<std::uint16_t> row_sums) {
  const int width = in.width;
  std::uint16_t* sums = row_sums.data() + 8;
  for (int y = 0; y < out.height; ++y) {
    const std::uint8_t* r0 = clamped_row(in, 2 * y - 2);
    const std::uint8_t* r1 = clamped_row(in, 2 * y - 1);
    const std::uint8_t* r2 = clamped_row(in, 2 * y);
    const std::uint8_t* r3 = clamped_row(in, 2 * y + 1);
    const std::uint8_t* r4 = clamped_row(in, 2 * y + 2);
    for (int x = 0; x < width; ++x)
      sums[x] = static_cast<std::uint16_t>(r0[x] + r4[x] + 4 * (r1[x] + r3[x]) + 6 * r2[x]);
    repeat_borders(sums, width, 3);
    std::uint8_t* line = out.row(y);
    int x = 0;
    if constexpr (!kSimdLoops)
      for (; x + 8 <= out.width; x += 8) binomial5_of_eight(sums + 2 * x, line + x);
    for (; x < out.width; ++x) line[x] = binomial5(sums + 2 * x);
  }
}

}  // namespace plvo
