// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/gray.hpp"

#include <cstring>

#include "plvo/base/build.hpp"
#include "plvo/base/lanes.hpp"

namespace plvo {
namespace {

template <int First, int Third>
std::uint8_t luma(const std::uint8_t* p) {
  return static_cast<std::uint8_t>((First * p[0] + 150 * p[1] + Third * p[2] + 128) >> 8);
}

// Of eight pixels; p reaches one byte beyond them. A pixel is the first three of four bytes in a row.
template <int First, int Third>
void luma_of_eight(const std::uint8_t* p, std::uint8_t* out) {
  constexpr Lanes kLumaWeights = {First, 150, Third, 0, First, 150, Third, 0};
  WideLanes sums[2];
  for (int i = 0; i < 2; ++i, p += 12) {
    const std::uint8_t* const pixels[4] = {p, p + 3, p + 6, p + 9};
    Lanes first_two, others;
    load_bytes(pixels, first_two, others);
    WideLanes halves[2];
    dot_pairs(first_two, kLumaWeights, halves[0]);
    dot_pairs(others, kLumaWeights, halves[1]);
    add_pairs(halves[0], halves[1], sums[i]);
    sums[i] = (sums[i] + 128) >> 8;
  }
  Lanes eight;
  narrow(sums[0], sums[1], eight);
  store_bytes(eight, out);
}

template <int First, int Third>
void luma_row(const std::uint8_t* pixels, int width, std::uint8_t* out) {
  int x = 0;
  if constexpr (!kLaneLoops)
    for (; x + 8 < width; x += 8) luma_of_eight<First, Third>(pixels + 3 * x, out + x);
  for (; x < width; ++x) out[x] = luma<First, Third>(pixels + 3 * x);
}

}  // namespace

void to_gray(const ColourView& colour, ImageView<std::uint8_t> gray) {
  for (int y = 0; y < gray.height; ++y) {
    const std::uint8_t* row = colour.data + y * colour.stride_bytes;
    switch (colour.format) {
      case PixelFormat::kGray8: std::memcpy(gray.row(y), row, static_cast<std::size_t>(gray.width)); break;
      case PixelFormat::kRgb8: luma_row<77, 29>(row, gray.width, gray.row(y)); break;
      case PixelFormat::kBgr8: luma_row<29, 77>(row, gray.width, gray.row(y)); break;
    }
  }
}

double mean_brightness(GrayView gray) {
  std::uint64_t sum = 0;
  std::uint64_t count = 0;
  for (int y = 0; y < gray.height; y += 4) {
    for (int x = 0; x < gray.width; x += 4) {
      sum += gray.row(y)[x];
      ++count;
    }
  }
  return count == 0 ? 0 : static_cast<double>(sum) / static_cast<double>(count);
}

}  // namespace plvo
