// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/gray.hpp"

#include <cstring>

#include "plvo/base/simd.hpp"

namespace plvo {
namespace {

// Weights of a pixel's three bytes, in 1/256. They are run-time data on purpose: compilers would replace
// products with constants by shifts and sums.
struct LumaWeights {
  std::uint16_t first, second, third;
};
constexpr LumaWeights kLumaWeights[] = {{77, 150, 29}, {29, 150, 77}};  // RGB, BGR

#ifdef __SSE2__

using Sums = std::uint16_t __attribute__((vector_size(16)));

Bytes from_eighth(const Bytes& a) {
  return __builtin_shufflevector(a, a, 8, 9, 10, 11, 12, 13, 14, 15, 8, 9, 10, 11, 12, 13, 14, 15);
}

Sums widened(const Bytes& eight) {
  const Bytes wide = in_turns(eight, Bytes{});
  Sums sums;
  std::memcpy(&sums, &wide, sizeof sums);
  return sums;
}

// Luma of sixteen pixels, 48 bytes. Interleaving the two halves of the 48 bytes moves byte i to 2i mod 47.
// Three such steps move channel c of pixel 2k from 6k + c to k + 8c, and that of pixel 2k + 1 from 6k + 3 + c
// to k + 24 + 8c.
void luma_of_sixteen(const std::uint8_t* p, LumaWeights w, std::uint8_t* out) {
  Bytes a, b, c;
  std::memcpy(&a, p, sizeof a);
  std::memcpy(&b, p + 16, sizeof b);
  std::memcpy(&c, p + 32, sizeof c);
  for (int i = 0; i < 3; ++i) {
    const Bytes first = in_turns(a, from_eighth(b));
    const Bytes second = in_turns(from_eighth(a), c);
    c = in_turns(b, from_eighth(c));
    a = first;
    b = second;
  }
  // At most 256 · 255 + 128, which fits in 16 bits.
  const auto luma = [&](const Bytes& first, const Bytes& second, const Bytes& third) {
    return widened(first) * w.first + widened(second) * w.second + widened(third) * w.third +
           std::uint16_t{128};
  };
  const Sums even = luma(a, from_eighth(a), b);
  const Sums odd = luma(from_eighth(b), c, from_eighth(c));
  const Sums sixteen = even >> 8 | (odd & std::uint16_t{0xff00});
  std::memcpy(out, &sixteen, sizeof sixteen);
}

#endif

void luma_row(const std::uint8_t* pixels, int width, LumaWeights w, std::uint8_t* __restrict out) {
  int x = 0;
#ifdef __SSE2__
  for (; x + 16 <= width; x += 16) luma_of_sixteen(pixels + 3 * x, w, out + x);
#endif
  // On processors with an instruction that loads every third byte, compilers vectorise this loop in the same
  // way.
  for (; x < width; ++x) {
    const std::uint8_t* const p = pixels + 3 * x;
    out[x] = static_cast<std::uint8_t>((w.first * p[0] + w.second * p[1] + w.third * p[2] + 128) >> 8);
  }
}

}  // namespace

void to_gray(const ColourView& colour, ImageView<std::uint8_t> gray) {
  for (int y = 0; y < gray.height; ++y) {
    const std::uint8_t* row = colour.data + y * colour.stride_bytes;
    if (colour.format == PixelFormat::kGray8)
      std::memcpy(gray.row(y), row, static_cast<std::size_t>(gray.width));
    else
      luma_row(row, gray.width, kLumaWeights[colour.format == PixelFormat::kBgr8 ? 1 : 0], gray.row(y));
  }
}

double mean_brightness(GrayView gray, const ImageMask& mask) {
  std::uint64_t sum = 0;
  std::uint64_t count = 0;
  for (int y = 0; y < gray.height; y += 4) {
    for (int x = 0; x < gray.width; x += 4) {
      if (!mask.is_free(x, y, 0)) continue;
      sum += gray.row(y)[x];
      ++count;
    }
  }
  return count == 0 ? 0 : static_cast<double>(sum) / static_cast<double>(count);
}

}  // namespace plvo
