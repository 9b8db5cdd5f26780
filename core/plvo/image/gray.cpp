// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/gray.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace plvo {
namespace {

// Weights of three bytes in a row, at every byte and not only where a pixel begins: two thirds are thrown
// away, but nothing has to be sorted by channel, and compilers do eight at once. No sum passes 16 bits.
template <int First, int Third>
void luma_row(const std::uint8_t* pixels, int width, std::uint8_t* out) {
  constexpr int kBlock = 64;
  std::array<std::uint8_t, 3 * kBlock> luma;
  for (int block = 0; block < width; block += kBlock) {
    const int count = std::min(kBlock, width - block);
    const std::uint8_t* p = pixels + 3 * block;
    const int bytes = std::min(3 * kBlock, 3 * (width - block) - 2);
    for (int k = 0; k < bytes; ++k) {
      const auto first = static_cast<std::uint16_t>(First * p[k]);
      const auto second = static_cast<std::uint16_t>(150 * p[k + 1]);
      const auto third = static_cast<std::uint16_t>(Third * p[k + 2]);
      const auto sum = static_cast<std::uint16_t>(first + second + third + 128);
      luma[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(sum >> 8);
    }
    int x = 0;
    for (; x + 8 <= count; x += 8) {
      std::uint64_t eight = 0;
      for (int i = 7; i >= 0; --i) eight = eight << 8 | luma[static_cast<std::size_t>(3 * (x + i))];
      std::memcpy(out + block + x, &eight, sizeof eight);
    }
    for (; x < count; ++x) out[block + x] = luma[static_cast<std::size_t>(3 * x)];
  }
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
