// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/level_line_field.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "plvo/base/bits.hpp"
#include "plvo/base/build.hpp"
#include "plvo/base/simd.hpp"
#include "plvo/lines/lsd/angle_range.hpp"

namespace plvo::lsd {
namespace {

// An error of q may rotate a gradient of magnitude rho = q / sin(tau) or less by more than tau. Rounding to
// integers changes each of four pixels by at most 1/2, hence a component by at most 1 and the vector by at
// most √2. The paper takes q = 2 because of noise, at full resolution. The constant is the squared limit, in
// half grey levels: (2 · √2 / sin 22.5°)².
constexpr int kMinMagnitudeSquared = 55;

// Bins of 3/8 grey level: 962 up to the greatest magnitude, 8 · 510 · √2. Bin 0 holds the strongest.
constexpr std::int16_t kBins = 1024;
constexpr std::int16_t kBinsPerUnit_q16 = 65536 / 6 + 1;  // exact for numbers below 2^15

// atan(r) / r in units of Angle for 0 ≤ r ≤ 1: a polynomial in r² with a greatest error of 0.12 units (least
// squares, weighted until all its extremes are equal).
constexpr float kArcTangent[5] = {10428.9841F, -3445.2039F, 1879.1296F, -888.21295F, 217.42242F};

// Selects the octant with integers, so that compilers can vectorise the function. For a zero gradient, both
// results are 0.
inline __attribute__((always_inline)) PolarGradient polar(int gx, int gy) {
  const int ax = gx < 0 ? -gx : gx, ay = gy < 0 ? -gy : gy;
  const int major = ax > ay ? ax : ay, minor = ax > ay ? ay : ax;
  const float r = static_cast<float>(minor) / static_cast<float>(major > 0 ? major : 1);
  const float r2 = r * r;
  const auto& c = kArcTangent;
  const float p = (((c[4] * r2 + c[3]) * r2 + c[2]) * r2 + c[1]) * r2 + c[0];
  int angle = static_cast<int>(p * r + 0.5F);
  angle = ay > ax ? 16384 - angle : angle;
  angle = gx < 0 ? 32768 - angle : angle;
  angle = gy < 0 ? -angle : angle;
  const float magnitude = 8 * __builtin_sqrtf(static_cast<float>(gx * gx + gy * gy));
  return {static_cast<Angle>(angle), static_cast<std::int16_t>(static_cast<int>(magnitude + 0.5F))};
}

// The gradients of a block.
struct BlockGradients {
  std::int16_t gx[kBlockPixels], gy[kBlockPixels];
};

// Computes the gradients of eight entries. Returns a mask of those whose magnitude exceeds the quantisation
// noise. Nine bytes must be readable from above and from below.
unsigned make_gradients(const std::uint8_t* above, const std::uint8_t* below, BlockGradients& out) {
  Int16x8 a, b, c, d;
  load_bytes(above, a);
  load_bytes(above + 1, b);
  load_bytes(below, c);
  load_bytes(below + 1, d);
  const Int16x8 diagonal = d - a;
  const Int16x8 antidiagonal = b - c;
  const Int16x8 gx = diagonal + antidiagonal;
  const Int16x8 gy = diagonal - antidiagonal;
  store(gx, out.gx);
  store(gy, out.gy);
  Int16x8 pairs[2];
  interleave(gx, gy, pairs[0], pairs[1]);
  Int32x4 squares[2];
  dot_pairs(pairs[0], pairs[0], squares[0]);
  dot_pairs(pairs[1], pairs[1], squares[1]);
  const Int32x4 most = Int32x4{} + kMinMagnitudeSquared;
  const Int32x4 first = most - squares[0], last = most - squares[1];
  return negative_mask(first) | negative_mask(last) << 4;
}

// Pixels of the full image that are read to either side of a segment, at most: for its gradients, and for its
// localisation (edge_localisation.hpp), which moves it.
constexpr int kSegmentReach_px = 8;

// A bit for each entry of the block that is away from masked pixels.
unsigned free_entries(const FieldMask& masked, int x, int y) {
  unsigned bits = 0;
  for (int i = 0; i < kBlockPixels; ++i)
    if (masked.mask->is_free(static_cast<int>((x + i + 0.5) * masked.scale),
                             static_cast<int>((masked.row_0 + y + 0.5) * masked.scale), kSegmentReach_px))
      bits |= 1U << i;
  return bits;
}

// Calls with_bin(i, bin) for the pixels of a block that have an angle, first to last. With SIMD vectors, it
// is also called for the other pixels, with bins from kBins on, because a branch on them is unpredictable.
constexpr std::size_t kAllBins = kSimdLoops ? kBins : 2 * kBins;
template <typename WithBin>
void for_each_bin(const std::int16_t* magnitudes, unsigned bits, WithBin&& with_bin) {
  if constexpr (kSimdLoops) {
    for (unsigned rest = bits; rest != 0; rest &= rest - 1) {
      const int i = lowest_bit(rest);
      with_bin(i, static_cast<std::size_t>(kBins - 1 - (magnitudes[i] * kBinsPerUnit_q16 >> 16)));
    }
    return;
  }
  Int16x8 bins;
  load(magnitudes, bins);
  multiply_high(bins, Int16x8{} + kBinsPerUnit_q16, bins);
  // chosen() + 1 is 0 for pixels with an angle and 1 for the others.
  bins = (chosen(bits) + std::int16_t{1}) * kBins + std::int16_t{kBins - 1} - bins;
  for (int i = 0; i < kBlockPixels; ++i) with_bin(i, static_cast<std::uint16_t>(bins[i]));
}

}  // namespace

PolarGradient polar_gradient(int gx, int gy) { return polar(gx, gy); }

void compute_field(GrayView image, LevelLineField& field, const FieldMask& masked) {
  std::fill(field.padded_open.begin(), field.padded_open.end(), std::uint8_t{0});
  std::uint8_t* const directed = field.directed.data();
  std::uint8_t* const open = field.open();
  Angle* const angles = field.angles();
  std::int16_t* const magnitudes = field.magnitude_and_releases.data();
  std::array<std::uint32_t, kAllBins> places{};  // counts first, then positions
  const int blocks = field.stride - 1;
  const bool has_mask = masked.mask != nullptr && masked.mask->active();
  for (int y = 0; y < field.height; ++y) {
    const std::uint8_t* above = image.row(y);
    const std::uint8_t* below = image.row(y + 1);
    for (int block = 0; block < blocks; ++block) {
      const int x = block * kBlockPixels;
      const int left = field.width - x;
      const std::ptrdiff_t at = field.index(block, y);
      BlockGradients gradients;
      unsigned bits;
      if (left > kBlockPixels) {
        bits = make_gradients(above + x, below + x, gradients);
      } else {
        // The bytes after the end of the row may lie outside of the image.
        std::uint8_t ends[2][kBlockPixels + 1] = {};
        std::memcpy(ends[0], above + x, static_cast<std::size_t>(left + 1));
        std::memcpy(ends[1], below + x, static_cast<std::size_t>(left + 1));
        bits = make_gradients(ends[0], ends[1], gradients) & ((1U << left) - 1);
      }
      if (has_mask) bits &= free_entries(masked, x, y);
      directed[at] = open[at] = static_cast<std::uint8_t>(bits);
      if (bits == 0) continue;
      Angle* const angle = angles + at * kBlockPixels;
      std::int16_t* const magnitude = magnitudes + at * kBlockPixels;
      const auto make_polar = [&](int i) {
        const PolarGradient gradient = polar(gradients.gx[i], gradients.gy[i]);
        angle[i] = gradient.angle;
        magnitude[i] = gradient.magnitude;
      };
      // With SIMD vectors, computes the pixels without an angle, too.
      if constexpr (!kSimdLoops)
        for (int i = 0; i < kBlockPixels; ++i) make_polar(i);
      else
        for (unsigned rest = bits; rest != 0; rest &= rest - 1) make_polar(lowest_bit(rest));
      for_each_bin(magnitude, bits, [&](int, std::size_t bin) { ++places[bin]; });
    }
    directed[field.index(blocks, y)] = 0;
  }
  // Converts the counts to the start of each bin. After all pixels are placed, each entry is the end of its
  // bin.
  std::uint32_t before = 0;
  for (std::uint32_t& of_bin : places) before += std::exchange(of_bin, before);
  PixelRun* const seeds = field.seeds.data();
  for (int y = 0; y < field.height; ++y) {
    for (int block = 0; block < blocks; ++block) {
      const std::ptrdiff_t at = field.index(block, y);
      const unsigned bits = directed[at];
      if (bits == 0) continue;
      for_each_bin(magnitudes + at * kBlockPixels, bits, [&](int i, std::size_t bin) {
        seeds[places[bin]++] = {static_cast<std::uint16_t>(y), static_cast<std::uint8_t>(block),
                                static_cast<std::uint8_t>(1 << i)};
      });
    }
  }
  field.seed_count = places[kBins - 1];
}

}  // namespace plvo::lsd
