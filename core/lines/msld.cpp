// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/msld.hpp"

#include <algorithm>

#include "plvo/math/trigonometry.hpp"

namespace plvo {

namespace {

constexpr int kRows = kMsldBands * kMsldRowsPerBand;
constexpr std::size_t kSums = 4 * kMsldBands;
constexpr int kDirectionBits = 8;
constexpr int kWeightBits = 6;
constexpr double kClip = 0.4;  // of a normalised half's component: no single strong edge may decide

// A row's share in the band it lies in and in the neighbour it lies towards (−1, 0, +1), times the Gaussian
// over the region: SD half the region's half width, so that an error in the segment's place changes little at
// the rim.
struct RowWeight {
  int band, neighbour;
  std::int32_t own, other;
};

constexpr double gaussian(double x) {  // exp(−x²/2) at compile time, |x| ≤ 2.1
  double term = 1, sum = 1;
  for (int k = 1; k < 40; ++k) {
    term *= -0.5 * x * x / k;
    sum += term;
  }
  return sum;
}

constexpr std::array<RowWeight, kRows> make_row_weights() {
  std::array<RowWeight, kRows> weights{};
  for (int r = 0; r < kRows; ++r) {
    const double row = r - 0.5 * (kRows - 1);
    const int band = r / kMsldRowsPerBand;
    // Position between band centres, in bands: −0.5 … 0.5.
    const double offset = (r % kMsldRowsPerBand - 0.5 * (kMsldRowsPerBand - 1)) / kMsldRowsPerBand;
    const double away = offset < 0 ? -offset : offset;
    const double g = gaussian(row / (0.5 * kRows)) * (1 << kWeightBits);
    weights[static_cast<std::size_t>(r)] = {band,
                                            offset < 0   ? band - 1
                                            : offset > 0 ? band + 1
                                                         : band,
                                            static_cast<std::int32_t>(g * (1 - away) + 0.5),
                                            static_cast<std::int32_t>(g * away + 0.5)};
  }
  return weights;
}
constexpr std::array<RowWeight, kRows> kRowWeights = make_row_weights();

// Positions in the image in 1/65536 px.
constexpr int kPositionBits = 16;
std::int32_t to_fixed(double x) {
  const double scaled = x * (1 << kPositionBits);
  return static_cast<std::int32_t>(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
}

struct Region {
  std::int32_t x, y;                      // of the first column's first row
  std::int32_t ux, uy;                    // from a column to the next
  std::int32_t nx, ny;                    // from a row to the next, towards the brighter side
  std::int32_t direction_x, direction_y;  // unit vector along the segment, kDirectionBits
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
      segment.a * scale + 0.5 * step * u - 0.5 * (kRows - 1) * kMsldRowPitch_px * n + Vector2(0.5, 0.5);
  region.x = to_fixed(first.x());
  region.y = to_fixed(first.y());
  region.ux = to_fixed(step * u.x());
  region.uy = to_fixed(step * u.y());
  region.nx = to_fixed(kMsldRowPitch_px * n.x());
  region.ny = to_fixed(kMsldRowPitch_px * n.y());
  region.direction_x = to_fixed(u.x()) >> (kPositionBits - kDirectionBits);
  region.direction_y = to_fixed(u.y()) >> (kPositionBits - kDirectionBits);
  return region;
}

// Are all samples, with the neighbours that a central difference needs, inside the image?
bool inside(const Region& region, GrayView image) {
  for (int corner = 0; corner < 4; ++corner) {
    const int c = corner % 2 == 0 ? 0 : region.columns - 1;
    const int r = corner / 2 == 0 ? 0 : kRows - 1;
    const int x = (region.x + c * region.ux + r * region.nx) >> kPositionBits;
    const int y = (region.y + c * region.uy + r * region.ny) >> kPositionBits;
    if (x < 1 || y < 1 || x >= image.width - 1 || y >= image.height - 1) return false;
  }
  return true;
}

struct Sums {
  std::array<std::int64_t, kSums> first{};   // Σ V over the columns
  std::array<std::int64_t, kSums> second{};  // Σ V²
};

// One column: V, four numbers for each band, with a band more at either end that is thrown away. Bounds: a
// gradient is below 2^9, times a direction 2^17, times the weights of a band's rows 2^25.
template <bool kInside>
void sum_column(GrayView image, const Region& region, std::int32_t x, std::int32_t y,
                std::array<std::int32_t, kSums + 8>& V) {
  V.fill(0);
  for (const RowWeight& row : kRowWeights) {
    const int px = x >> kPositionBits, py = y >> kPositionBits;
    x += region.nx;
    y += region.ny;
    if (!kInside && (px < 1 || py < 1 || px >= image.width - 1 || py >= image.height - 1)) continue;
    const std::uint8_t* p = image.data + py * image.stride + px;
    const std::int32_t gx = p[1] - p[-1];
    const std::int32_t gy = p[image.stride] - p[-image.stride];
    const std::int32_t across = gy * region.direction_x - gx * region.direction_y;
    const std::int32_t along = gx * region.direction_x + gy * region.direction_y;
    const std::int32_t parts[4] = {std::max(across, 0), std::max(-across, 0), std::max(along, 0),
                                   std::max(-along, 0)};
    std::int32_t* own = V.data() + 4 * (row.band + 1);
    std::int32_t* other = V.data() + 4 * (row.neighbour + 1);
    for (int k = 0; k < 4; ++k) own[k] += parts[k] * row.own;
    for (int k = 0; k < 4; ++k) other[k] += parts[k] * row.other;
  }
}

template <bool kInside>
void sum_region(GrayView image, const Region& region, Sums& sums) {
  std::array<std::int32_t, kSums + 8> V;
  std::int32_t x = region.x, y = region.y;
  for (int c = 0; c < region.columns; ++c) {
    sum_column<kInside>(image, region, x, y, V);
    for (std::size_t k = 0; k < kSums; ++k) {
      const std::int64_t v = V[k + 4];
      sums.first[k] += v;
      sums.second[k] += v * v;
    }
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
  Sums sums;
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
