// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/level_line_field.hpp"

#include <algorithm>
#include <array>

#include "plvo/base/build.hpp"

namespace plvo::lsd {
namespace {

constexpr int kMaxComponent = 510;  // of a gradient in half grey levels
constexpr std::uint32_t kRatioSteps = 1024;

constexpr double constexpr_sqrt(double x) {  // 1 ≤ x ≤ 2
  double root = 1.2;
  for (int i = 0; i < 4; ++i) root = 0.5 * (root + x / root);
  return root;
}

// Of a gradient whose larger component is 1 and whose smaller one is ratio / 1024: the unit vector and the
// length.
struct OctantEntry {
  std::uint16_t major = 0;   // · 2^-14
  std::uint16_t minor = 0;   // · 2^-14
  std::uint16_t length = 0;  // · 2^-14
};

constexpr OctantEntry make_entry(std::uint32_t step) {
  const double ratio = static_cast<double>(step) / kRatioSteps;
  const double length = constexpr_sqrt(1 + ratio * ratio);
  const double one = 1 << kDirectionBits;
  return {static_cast<std::uint16_t>(one / length + 0.5),
          static_cast<std::uint16_t>(one * ratio / length + 0.5),
          static_cast<std::uint16_t>(one * length + 0.5)};
}

constexpr std::array<OctantEntry, kRatioSteps + 1> make_octant() {
  std::array<OctantEntry, kRatioSteps + 1> octant{};
  for (std::uint32_t step = 0; step <= kRatioSteps; ++step) octant[step] = make_entry(step);
  return octant;
}

// 2^16 · 1024 / component: a multiplication in place of the division that the ratio asks for.
constexpr std::uint32_t make_reciprocal(std::uint32_t component) {
  return ((kRatioSteps << 16) + component / 2) / component;
}

constexpr std::array<std::uint32_t, kMaxComponent + 1> make_reciprocals() {
  std::array<std::uint32_t, kMaxComponent + 1> reciprocals{};
  for (std::uint32_t i = 1; i <= kMaxComponent; ++i) reciprocals[i] = make_reciprocal(i);
  return reciprocals;
}

constexpr auto kOctant = make_octant();
constexpr auto kReciprocals = make_reciprocals();

OctantEntry octant_entry(std::uint32_t step) {
  if constexpr (kSmallCode) return make_entry(step);
  return kOctant[step];
}
std::uint32_t reciprocal(std::uint32_t component) {
  if constexpr (kSmallCode) return make_reciprocal(component);
  return kReciprocals[component];
}

// A gradient of at most rho = q / sin(tau) may be turned by more than tau by an error of q. Rounding to
// integers moves each of four pixels by at most 1/2, so a component by at most 1 and the vector by at most
// √2; the paper takes q = 2 for noise's sake, at full resolution. Squared, in half grey levels: (2 · √2 /
// sin 22.5°)².
constexpr int kMinMagnitudeSquared = 55;

// Bins of 3/8 grey level: 962 up to the greatest magnitude, 16 · 510 · √2. Bin 0 holds the strongest.
constexpr std::size_t kBins = 1024;
constexpr std::size_t bin_of(std::uint16_t magnitude) { return kBins - 1 - magnitude / 12U; }

// Gradients of one row in blocks that a compiler can do side by side, then the few pixels that matter one by
// one.
class RowGradients {
 public:
  static constexpr int kBlock = 64;

  // Of `count` ≤ kBlock entries from column x on.
  void compute(const std::uint8_t* above, const std::uint8_t* below, int count) {
    for (int i = 0; i < count; ++i) {
      const int diagonal = below[i + 1] - above[i];
      const int antidiagonal = above[i + 1] - below[i];
      const auto gx = static_cast<std::int16_t>(diagonal + antidiagonal);
      const auto gy = static_cast<std::int16_t>(diagonal - antidiagonal);
      gx_[static_cast<std::size_t>(i)] = gx;
      gy_[static_cast<std::size_t>(i)] = gy;
      strong_[static_cast<std::size_t>(i)] =
          static_cast<int>(gx) * gx + static_cast<int>(gy) * gy > kMinMagnitudeSquared ? 1 : 0;
    }
    // Which are strong cannot be foreseen, so nothing branches on it: each is written down, and stays if it
    // is.
    std::size_t strong_count = 0;
    for (int i = 0; i < count; ++i) {
      strong_entries_[strong_count] = static_cast<std::uint8_t>(i);
      strong_count += static_cast<std::size_t>(strong_[static_cast<std::size_t>(i)]);
    }
    strong_count_ = strong_count;
  }
  std::span<const std::uint8_t> strong() const { return std::span(strong_entries_).first(strong_count_); }
  PolarGradient polar(int i) const {
    return polar_gradient(gx_[static_cast<std::size_t>(i)], gy_[static_cast<std::size_t>(i)]);
  }

 private:
  std::array<std::int16_t, kBlock> gx_{};
  std::array<std::int16_t, kBlock> gy_{};
  std::array<std::int32_t, kBlock> strong_{};
  std::array<std::uint8_t, kBlock> strong_entries_{};
  std::size_t strong_count_ = 0;
};

}  // namespace

PolarGradient polar_gradient(int gx, int gy) {
  const auto ax = static_cast<std::uint32_t>(gx < 0 ? -gx : gx);
  const auto ay = static_cast<std::uint32_t>(gy < 0 ? -gy : gy);
  const bool x_is_major = ax >= ay;
  const std::uint32_t major = x_is_major ? ax : ay;
  const std::uint32_t minor = x_is_major ? ay : ax;
  const OctantEntry entry = octant_entry((minor * reciprocal(major) + 0x8000U) >> 16);
  const int x = x_is_major ? entry.major : entry.minor;
  const int y = x_is_major ? entry.minor : entry.major;
  return {{static_cast<std::int16_t>(gx < 0 ? -x : x), static_cast<std::int16_t>(gy < 0 ? -y : y)},
          static_cast<std::uint16_t>((major * entry.length + 512U) >> 10)};
}

void compute_field(GrayView image, LevelLineField& field, std::span<Pixel> unordered) {
  std::fill(field.state.begin(), field.state.end(), kUsed);
  std::fill(field.direction.begin(), field.direction.end(), Direction{});
  std::uint8_t* const states = field.state.data();
  Direction* const directions = field.direction.data();
  std::uint16_t* const magnitudes = field.magnitude.data();
  Pixel* const found = unordered.data();
  std::array<std::uint32_t, kBins + 1> starts{};
  std::size_t count = 0;
  RowGradients gradients;
  for (int y = 0; y < field.height; ++y) {
    const std::uint8_t* above = image.row(y);
    const std::uint8_t* below = image.row(y + 1);
    for (int block = 0; block < field.width; block += RowGradients::kBlock) {
      const int size = std::min(RowGradients::kBlock, field.width - block);
      gradients.compute(above + block, below + block, size);
      const std::size_t first = field.index(block, y);
      for (const int i : gradients.strong()) {
        const PolarGradient polar = gradients.polar(i);
        const std::size_t at = first + static_cast<std::size_t>(i);
        states[at] = 0;
        // Number by number: put together in memory, the pair would be read back before it is there.
        directions[at].x = polar.direction.x;
        directions[at].y = polar.direction.y;
        magnitudes[at] = polar.magnitude;
        ++starts[bin_of(polar.magnitude) + 1];
        found[count++] = {static_cast<std::int16_t>(block + i), static_cast<std::int16_t>(y)};
      }
    }
  }
  for (std::size_t bin = 0; bin < kBins; ++bin) starts[bin + 1] += starts[bin];
  for (const Pixel& pixel : unordered.first(count)) {
    field.seeds[starts[bin_of(magnitudes[field.index(pixel.x, pixel.y)])]++] = pixel;
  }
  field.seed_count = count;
}

}  // namespace plvo::lsd
