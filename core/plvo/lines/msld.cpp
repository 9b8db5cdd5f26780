// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/msld.hpp"

#include <algorithm>

#include "plvo/math/rounding.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {

namespace {

constexpr std::size_t kMsldRows = kMsldBands * kMsldRowsPerBand;
constexpr std::size_t kSums = 4 * kMsldBands;
constexpr double kClip = 0.4;  // of a normalised half's component: no single strong edge may decide

// exp(−x²/2) at compile time, |x| ≤ 1.
constexpr double gaussian(double x) {
  double term = 1, sum = 1;
  for (int k = 1; k < 40; ++k) {
    term *= -0.5 * x * x / k;
    sum += term;
  }
  return sum;
}

// A band takes its own rows and, falling linearly to the next band's centre, its neighbours' nearer rows:
// kMsldReach rows to either side of its centre. The Gaussian over the whole region has half its half width
// for SD, so that an error in the segment's place changes little at the rim.
constexpr int kMsldReach = kMsldRowsPerBand - 1;
static_assert(kMsldRowsPerBand % 2 == 1, "a band's centre is a row");
using BandWeights = std::array<float, 2 * kMsldReach + 1>;

constexpr std::array<BandWeights, kMsldBands> make_msld_weights() {
  std::array<BandWeights, kMsldBands> weights{};
  for (int band = 0; band < kMsldBands; ++band)
    for (int o = -kMsldReach; o <= kMsldReach; ++o) {
      const double row = (band - kMsldBands / 2) * kMsldRowsPerBand + o;
      const double share = 1.0 - (o < 0 ? -o : o) / static_cast<double>(kMsldRowsPerBand);
      weights[static_cast<std::size_t>(band)][static_cast<std::size_t>(o + kMsldReach)] =
          static_cast<float>(share * gaussian(row / (0.5 * kMsldRows)));
    }
  return weights;
}
constexpr std::array<BandWeights, kMsldBands> kMsldWeights = make_msld_weights();

// Positions in the image in 1/65536 px.
constexpr int kPositionBits = 16;
std::int32_t to_fixed(double x) { return round_to<std::int32_t>(x * (1 << kPositionBits)); }

struct Region {
  std::int32_t x, y;               // of the first column's first row
  std::int32_t ux, uy;             // from a column to the next
  std::int32_t nx, ny;             // from a row to the next, towards the brighter side
  float direction_x, direction_y;  // unit vector along the segment
  int columns;
};

Region make_region(double scale, const Segment& segment) {
  const Vector2 u = segment.direction(), n = segment.normal();
  const double length = segment.length_px() * scale;
  Region region;
  region.columns = std::clamp(static_cast<int>(length), 1, kMsldMaxColumns);
  const double step = length / region.columns;
  // Half a pixel is added, so that truncation rounds to the nearest pixel.
  const Vector2 first =
      segment.a * scale + 0.5 * step * u - 0.5 * (kMsldRows - 1.0) * kMsldRowPitch_px * n + Vector2(0.5, 0.5);
  region.x = to_fixed(first.x());
  region.y = to_fixed(first.y());
  region.ux = to_fixed(step * u.x());
  region.uy = to_fixed(step * u.y());
  region.nx = to_fixed(kMsldRowPitch_px * n.x());
  region.ny = to_fixed(kMsldRowPitch_px * n.y());
  region.direction_x = static_cast<float>(u.x());
  region.direction_y = static_cast<float>(u.y());
  return region;
}

// Are all samples, with the neighbours that a central difference needs, inside the image?
bool inside(const Region& region, GrayView image) {
  for (int corner = 0; corner < 4; ++corner) {
    const int c = corner % 2 == 0 ? 0 : region.columns - 1;
    const int r = corner / 2 == 0 ? 0 : static_cast<int>(kMsldRows) - 1;
    const int x = (region.x + c * region.ux + r * region.nx) >> kPositionBits;
    const int y = (region.y + c * region.uy + r * region.ny) >> kPositionBits;
    if (x < 1 || y < 1 || x >= image.width - 1 || y >= image.height - 1) return false;
  }
  return true;
}

struct ColumnSums {
  std::array<float, kSums> first{};   // Σ V over the columns
  std::array<float, kSums> second{};  // Σ V²
};

// The gradients of one column, each as four non-negative parts: towards the brighter side, away from it,
// along the segment, against it. A margin of zero rows on both sides stands for the rows beyond the region.
using Column = std::array<std::array<float, 4>, kMsldRows + 2 * kMsldReach>;

template <bool kInside>
void read_column(GrayView image, const Region& region, std::int32_t x, std::int32_t y, Column& column) {
  for (std::size_t r = kMsldReach; r < kMsldRows + kMsldReach; ++r) {
    const int px = x >> kPositionBits, py = y >> kPositionBits;
    x += region.nx;
    y += region.ny;
    if (!kInside && (px < 1 || py < 1 || px >= image.width - 1 || py >= image.height - 1)) {
      column[r] = {};
      continue;
    }
    const std::uint8_t* p = image.data + py * image.stride + px;
    const auto gx = static_cast<float>(p[1] - p[-1]);
    const auto gy = static_cast<float>(p[image.stride] - p[-image.stride]);
    const float across = gy * region.direction_x - gx * region.direction_y;
    const float along = gx * region.direction_x + gy * region.direction_y;
    column[r] = {std::max(across, 0.0F), std::max(-across, 0.0F), std::max(along, 0.0F),
                 std::max(-along, 0.0F)};
  }
}

// The four parts are independent lanes, each summed in one order: a compiler may do them side by side.
void add_column(const Column& column, ColumnSums& sums) {
  for (std::size_t band = 0; band < kMsldBands; ++band) {
    std::array<float, 4> V{};
    for (std::size_t o = 0; o < 2 * kMsldReach + 1; ++o)
      for (std::size_t k = 0; k < 4; ++k)
        V[k] += kMsldWeights[band][o] * column[band * kMsldRowsPerBand + kMsldRowsPerBand / 2 + o][k];
    for (std::size_t k = 0; k < 4; ++k) {
      sums.first[4 * band + k] += V[k];
      sums.second[4 * band + k] += V[k] * V[k];
    }
  }
}

template <bool kInside>
void sum_region(GrayView image, const Region& region, ColumnSums& sums) {
  Column column{};
  std::int32_t x = region.x, y = region.y;
  for (int c = 0; c < region.columns; ++c) {
    read_column<kInside>(image, region, x, y, column);
    add_column(column, sums);
    x += region.ux;
    y += region.uy;
  }
}

// Unit norm, clipped, unit norm again, in units of 1/255.
void normalise(std::array<double, kSums>& half, std::uint8_t* out) {
  for (int round = 0; round < 2; ++round) {
    double squared = 0;
    for (const double v : half) squared += v * v;
    if (!(squared > 0)) return;
    const double inverse = 1.0 / sqrt(squared);
    for (double& v : half) {
      v *= inverse;
      if (round == 0) v = std::min(v, kClip);
    }
  }
  for (std::size_t k = 0; k < kSums; ++k) out[k] = static_cast<std::uint8_t>(half[k] * 255 + 0.5);
}

}  // namespace

LineDescriptor describe_segment(GrayView image, double scale, const Segment& segment) {
  LineDescriptor descriptor;
  if (!(segment.length_px() > 0)) return descriptor;
  const Region region = make_region(scale, segment);
  ColumnSums sums;
  if (inside(region, image))
    sum_region<true>(image, region, sums);
  else
    sum_region<false>(image, region, sums);

  std::array<double, kSums> mean, deviation;
  const double inverse = 1.0 / region.columns;
  for (std::size_t k = 0; k < kSums; ++k) {
    mean[k] = static_cast<double>(sums.first[k]) * inverse;
    const double variance = static_cast<double>(sums.second[k]) * inverse - mean[k] * mean[k];
    deviation[k] = variance > 0 ? sqrt(variance) : 0;
  }
  normalise(mean, descriptor.value.data());
  normalise(deviation, descriptor.value.data() + kSums);
  return descriptor;
}

int descriptor_distance(const LineDescriptor& a, const LineDescriptor& b) {
  int sum = 0;
  for (std::size_t k = 0; k < kMsldLength; ++k) {
    const int difference = a.value[k] - b.value[k];
    sum += difference * difference;
  }
  return sum;
}

}  // namespace plvo
