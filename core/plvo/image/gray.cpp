// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/gray.hpp"

#include <cstring>

namespace plvo {
namespace {

template <int RedIndex>
void luma_row(const std::uint8_t* pixels, int width, std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    const std::uint8_t* p = pixels + 3 * x;
    out[x] = static_cast<std::uint8_t>((77 * p[RedIndex] + 150 * p[1] + 29 * p[2 - RedIndex] + 128) >> 8);
  }
}

}  // namespace

void to_gray(const ColourView& colour, ImageView<std::uint8_t> gray) {
  for (int y = 0; y < gray.height; ++y) {
    const std::uint8_t* row = colour.data + y * colour.stride_bytes;
    switch (colour.format) {
      case PixelFormat::kGray8: std::memcpy(gray.row(y), row, static_cast<std::size_t>(gray.width)); break;
      case PixelFormat::kRgb8: luma_row<0>(row, gray.width, gray.row(y)); break;
      case PixelFormat::kBgr8: luma_row<2>(row, gray.width, gray.row(y)); break;
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
