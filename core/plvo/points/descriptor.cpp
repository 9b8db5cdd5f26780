// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/descriptor.hpp"

#include <cstring>

#include "plvo/base/bits.hpp"
#include "plvo/base/random.hpp"

namespace plvo {
namespace {

struct PixelPair {
  std::int8_t ax, ay, bx, by;
};

// Draws a near-Gaussian integer with a standard deviation of 6, within ±kDescriptorRadius. The sum of six
// uniform integers on 0 … 8 has variance 40; the bound reduces it.
constexpr std::int8_t draw_offset(Random& random) {
  for (;;) {
    int sum = -24;
    for (int i = 0; i < 6; ++i) sum += static_cast<int>(random.below(9));
    if (sum >= -kDescriptorRadius && sum <= kDescriptorRadius) return static_cast<std::int8_t>(sum);
  }
}

constexpr std::array<PixelPair, 256> make_pattern() {
  std::array<PixelPair, 256> pattern{};
  Random random(2015);
  for (PixelPair& pair : pattern) {
    // Comparisons of close pixels contain mostly noise, so the pixels are at least three pixels apart.
    int distance_squared = 0;
    do {
      pair = {draw_offset(random), draw_offset(random), draw_offset(random), draw_offset(random)};
      const int dx = pair.ax - pair.bx;
      const int dy = pair.ay - pair.by;
      distance_squared = dx * dx + dy * dy;
    } while (distance_squared < 9);
  }
  return pattern;
}

constexpr std::array<PixelPair, 256> kPattern = make_pattern();

}  // namespace

Describer::Describer(GrayView smoothed) : smoothed_(smoothed) {
  const auto stride = static_cast<std::int32_t>(smoothed.stride);
  for (std::size_t i = 0; i < kPattern.size(); ++i) {
    const PixelPair& pair = kPattern[i];
    offsets_[i] = {pair.ay * stride + pair.ax, pair.by * stride + pair.bx};
  }
}

Descriptor Describer::operator()(int x, int y) const {
  const std::uint8_t* centre = smoothed_.row(y) + x;
  Descriptor descriptor{};
  for (std::size_t word = 0; word < descriptor.size(); ++word) {
    std::uint64_t bits = 0;
    for (std::size_t i = 64; i-- > 0;) {
      const Offsets& offsets = offsets_[64 * word + i];
      bits = bits << 1 | static_cast<std::uint64_t>(centre[offsets.a] < centre[offsets.b]);
    }
    descriptor[word] = bits;
  }
  return descriptor;
}

int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return count_bits(a[0] ^ b[0]) + count_bits(a[1] ^ b[1]) + count_bits(a[2] ^ b[2]) +
         count_bits(a[3] ^ b[3]);
}

Patch cut_patch(GrayView image, int x, int y) {
  Patch patch;
  const std::uint8_t* row = image.row(y - kPatchRadius) + x - kPatchRadius;
  for (std::size_t i = 0; i < patch.size(); i += kPatchSide, row += image.stride)
    std::memcpy(&patch[i], row, kPatchSide);
  return patch;
}

}  // namespace plvo
