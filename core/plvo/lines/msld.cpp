// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/msld.hpp"

#include <algorithm>
#include <cstring>

#include "plvo/base/simd.hpp"
#include "plvo/math/rounding.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {

namespace {

constexpr std::size_t kMsldRows = kMsldBands * kMsldRowsPerBand;
constexpr std::size_t kSums = 4 * kMsldBands;
constexpr double kClip =
    0.4;  // limit of a component of a normalised half, so that no single strong edge dominates

// exp(−x²/2) at compile time, |x| ≤ 1.
constexpr double gaussian(double x) {
  double term = 1, sum = 1;
  for (int k = 1; k < 40; ++k) {
    term *= -0.5 * x * x / k;
    sum += term;
  }
  return sum;
}

// A band sums its own three rows and the nearest row of each adjacent band, with weights that fall linearly
// to the next band's centre. In thirds they are 1 for the last row before the band, 2 for its first row, 3
// for its centre, 2 for its last row and 1 for the first row after it. The Gaussian over the whole region has
// a standard deviation of half the region's half width, so that an error of the segment's position changes
// little at the rim. The row weight here is the Gaussian · 2^13, and three times that for a centre row.
//
// All sums are sums of integers, so they do not depend on the order.
static_assert(kMsldRowsPerBand == 3);
constexpr int kRowWeightBits = 13;
using RowWeights = std::array<std::int16_t, kMsldRows>;

constexpr RowWeights make_row_weights() {
  RowWeights weights{};
  for (std::size_t r = 0; r < kMsldRows; ++r) {
    const double row = static_cast<double>(r) - 0.5 * (kMsldRows - 1);
    const double share = r % kMsldRowsPerBand == kMsldRowsPerBand / 2 ? 3 : 1;
    weights[r] =
        static_cast<std::int16_t>(share * gaussian(row / (0.5 * kMsldRows)) * (1 << kRowWeightBits) + 0.5);
  }
  return weights;
}
constexpr RowWeights kRowWeights = make_row_weights();

// Positions in the image in 1/65536 px.
constexpr int kPositionBits = 16;
constexpr int kDirectionBits = 14;
std::int32_t to_fixed(double x) { return round_to<std::int32_t>(x * (1 << kPositionBits)); }

struct Region {
  std::int32_t x, y;                      // position of the first row of the first column
  std::int32_t ux, uy;                    // step from column to column
  std::int32_t nx, ny;                    // step from row to row, towards the brighter side
  std::int32_t direction_x, direction_y;  // unit vector along the segment · 2^14
  int columns;
};

Region make_region(double scale, const Segment& segment) {
  const Vector2 u = segment.direction(), n = segment.normal();
  const double length = segment.length_px() * scale;
  Region region;
  region.columns = std::clamp(static_cast<int>(length), 1, kMsldMaxColumns);
  const double step = length / region.columns;
  // Adds half a pixel, so that truncation rounds to the nearest pixel.
  const Vector2 first =
      segment.a * scale + 0.5 * step * u - 0.5 * (kMsldRows - 1.0) * kMsldRowPitch_px * n + Vector2(0.5, 0.5);
  region.x = to_fixed(first.x());
  region.y = to_fixed(first.y());
  region.ux = to_fixed(step * u.x());
  region.uy = to_fixed(step * u.y());
  region.nx = to_fixed(kMsldRowPitch_px * n.x());
  region.ny = to_fixed(kMsldRowPitch_px * n.y());
  region.direction_x = round_to<std::int32_t>(u.x() * (1 << kDirectionBits));
  region.direction_y = round_to<std::int32_t>(u.y() * (1 << kDirectionBits));
  return region;
}

// Returns whether all samples, and the adjacent pixels that are read with them, are inside the image.
bool inside(const Region& region, GrayView image) {
  for (int corner = 0; corner < 4; ++corner) {
    const int c = corner % 2 == 0 ? 0 : region.columns - 1;
    const int r = corner / 2 == 0 ? 0 : static_cast<int>(kMsldRows) - 1;
    const int x = (region.x + c * region.ux + r * region.nx) >> kPositionBits;
    const int y = (region.y + c * region.uy + r * region.ny) >> kPositionBits;
    if (x < 1 || y < 1 || x >= image.width - 3 || y >= image.height - 1) return false;
  }
  return true;
}

// A gradient of the image, in grey levels per two pixels, or a vector that it is multiplied with.
struct Gradient {
  std::int16_t x, y;
};

// Vectors whose products with a row's gradients are the weighted components across and along the segment,
// times 2^13.
struct RowAxes {
  Gradient across, along;
};

std::array<RowAxes, kMsldRows> make_axes(const Region& region) {
  std::array<RowAxes, kMsldRows> axes;
  for (std::size_t r = 0; r < kMsldRows; ++r) {
    const auto weighted = [&](std::int32_t q14) {
      return static_cast<std::int16_t>((kRowWeights[r] * q14 + (1 << (kDirectionBits - 1))) >>
                                       kDirectionBits);
    };
    const std::int16_t x = weighted(region.direction_x), y = weighted(region.direction_y);
    axes[r] = {{static_cast<std::int16_t>(-y), x}, {x, y}};
  }
  return axes;
}

// Components are kept in quarters of a unit: a band's sum is at most 9 · 255 · √2 · 4 and has 14 bits.
constexpr int kPartShift = kRowWeightBits - 2;
constexpr int kPartHalf = 1 << (kPartShift - 1);

template <bool kInside>
Gradient gradient(GrayView image, std::int32_t x, std::int32_t y) {
  const int px = x >> kPositionBits, py = y >> kPositionBits;
  if (!kInside && (px < 1 || py < 1 || px >= image.width - 1 || py >= image.height - 1)) return {0, 0};
  const std::uint8_t* p = image.data + py * image.stride + px;
  return {static_cast<std::int16_t>(p[1] - p[-1]),
          static_cast<std::int16_t>(p[image.stride] - p[-image.stride])};
}

// Sums of a band's four components over the columns: towards the brighter side, away from it, along the
// segment, against it.
struct BandSums {
  std::array<std::uint32_t, 4> first{};   // Σ V
  std::array<std::uint32_t, 4> second{};  // Σ V²
};
using RegionSums = std::array<BandSums, kMsldBands>;

#ifdef PLVO_SIMD_LOOPS

template <bool kInside>
void sum_region(GrayView image, const Region& region, RegionSums& sums) {
  const std::array<RowAxes, kMsldRows> axes = make_axes(region);
  for (int c = 0; c < region.columns; ++c) {
    // Rows of zeros at both ends replace the rows beyond the region.
    std::array<std::array<std::int32_t, 4>, kMsldRows + 2> column{};
    std::int32_t x = region.x + c * region.ux, y = region.y + c * region.uy;
    for (std::size_t r = 0; r < kMsldRows; ++r, x += region.nx, y += region.ny) {
      const Gradient g = gradient<kInside>(image, x, y);
      const auto part = [g](Gradient axis) {
        return (g.x * axis.x + g.y * axis.y + kPartHalf) >> kPartShift;
      };
      const std::int32_t across = part(axes[r].across), along = part(axes[r].along);
      column[r + 1] = {std::max<std::int32_t>(across, 0), std::max<std::int32_t>(-across, 0),
                       std::max<std::int32_t>(along, 0), std::max<std::int32_t>(-along, 0)};
    }
    for (std::size_t band = 0; band < kMsldBands; ++band)
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t r = band * kMsldRowsPerBand;
        const auto V = static_cast<std::uint32_t>(column[r][k] + 2 * column[r + 1][k] + column[r + 2][k] +
                                                  2 * column[r + 3][k] + column[r + 4][k]);
        sums[band].first[k] += V;
        sums[band].second[k] += V * V;
      }
  }
}

#else

// Components of four columns in parallel: first those across, then those along.
struct Parts {
  Int16x8 positive{}, negative{};
};

void repeat(Gradient g, Int16x8& vector) {
  std::int32_t both;
  std::memcpy(&both, &g, sizeof both);
  const Int32x4 four = Int32x4{} + both;
  std::memcpy(&vector, &four, sizeof vector);
}

// Reads four columns row by row. Columns from `columns` on have no gradient.
template <bool kInside>
class FourColumns {
 public:
  FourColumns(GrayView image, const Region& region, int first, int columns) : image_(image), region_(region) {
    for (int c = 0; c < 4; ++c) {
      const int column = first + (c < columns ? c : 0);
      x_[c] = region.x + column * region.ux;
      y_[c] = region.y + column * region.uy;
      counts_[2 * c] = counts_[2 * c + 1] = c < columns ? -1 : 0;
    }
  }

  void next(const RowAxes& axes, Parts& parts) {
    Int16x8 four, axis, both;
    if constexpr (kInside)
      read(four);
    else
      read_each(four);
    x_ += region_.nx;
    y_ += region_.ny;
    four = four & counts_;
    Int32x4 across, along;
    repeat(axes.across, axis);
    dot_pairs(four, axis, across);
    repeat(axes.along, axis);
    dot_pairs(four, axis, along);
    narrow((across + kPartHalf) >> kPartShift, (along + kPartHalf) >> kPartShift, both);
    parts.positive = both > 0 ? both : Int16x8{};
    parts.negative = parts.positive - both;
  }

 private:
  void read_each(Int16x8& four) const {
    Gradient gradients[4];
    for (int c = 0; c < 4; ++c) gradients[c] = gradient<false>(image_, x_[c], y_[c]);
    load_halves(&gradients[0].x, &gradients[2].x, four);
  }

  // The same for four positions at once. An element holds four adjacent bytes; the first of them is the left
  // neighbour, or the pixel above or below.
  void read(Int16x8& four) const {
    constexpr int kLow = 0xffff, kByte = 0xff;
    const auto stride = static_cast<std::int16_t>(image_.stride);
    const Int32x4 row_above_y = y_ - (1 << kPositionBits);
    const Int32x4 whole = (x_ >> kPositionBits & kLow) | (row_above_y & ~kLow);
    static_assert(kPositionBits == 16);
    Int16x8 places;
    std::memcpy(&places, &whole, sizeof places);
    Int32x4 offsets;
    dot_pairs(places, Int16x8{1, stride, 1, stride, 1, stride, 1, stride}, offsets);
    alignas(16) std::int32_t offset[4];
    store(offsets, offset);
    const std::uint8_t* row_above[4];
    for (int c = 0; c < 4; ++c) row_above[c] = image_.data + offset[c];
    const auto load_from = [&](std::ptrdiff_t behind, Int32x4& words) {
      const std::uint8_t* const at[4] = {row_above[0] + behind, row_above[1] + behind, row_above[2] + behind,
                                         row_above[3] + behind};
      load_words(at, words);
    };
    Int32x4 above, beside, below;
    load_from(0, above);
    load_from(image_.stride - 1, beside);
    load_from(2 * image_.stride, below);
    const Int32x4 first = (beside & kByte) | (above & kByte) << 16;
    const Int32x4 last = (beside >> 16 & kByte) | (below & kByte) << 16;
    Int16x8 from, to;
    std::memcpy(&from, &first, sizeof from);
    std::memcpy(&to, &last, sizeof to);
    four = to - from;
  }

  GrayView image_;
  const Region& region_;
  Int16x8 counts_{};
  Int32x4 x_{}, y_{};
};

// Σ V and Σ V² of one sign: first two pairs of columns across, then two along.
struct PairSums {
  Int32x4 first{}, second{};

  void add(const Int16x8& V) {
    Int32x4 pairs;
    dot_pairs(V, Int16x8{} + 1, pairs);
    first += pairs;
    dot_pairs(V, V, pairs);
    second += pairs;
  }
  void move(std::size_t sign, BandSums& sums) const {
    for (int k = 0; k < 2; ++k) {
      const std::size_t to = 2 * static_cast<std::size_t>(k) + sign;
      sums.first[to] =
          static_cast<std::uint32_t>(first[2 * k]) + static_cast<std::uint32_t>(first[2 * k + 1]);
      sums.second[to] =
          static_cast<std::uint32_t>(second[2 * k]) + static_cast<std::uint32_t>(second[2 * k + 1]);
    }
  }
};

template <bool kInside>
void sum_region(GrayView image, const Region& region, RegionSums& sums) {
  const std::array<RowAxes, kMsldRows> axes = make_axes(region);
  std::array<std::array<PairSums, 2>, kMsldBands> pairs{};
  for (int c = 0; c < region.columns; c += 4) {
    FourColumns<kInside> columns(image, region, c, std::min(region.columns - c, 4));
    Parts first, centre, last, V;
    for (std::size_t band = 0; band < kMsldBands; ++band) {
      const RowAxes* const rows = &axes[band * kMsldRowsPerBand];
      columns.next(rows[0], first);
      if (band > 0) {
        pairs[band - 1][0].add(V.positive + first.positive);
        pairs[band - 1][1].add(V.negative + first.negative);
      }
      V.positive = last.positive + first.positive + first.positive;
      V.negative = last.negative + first.negative + first.negative;
      columns.next(rows[1], centre);
      columns.next(rows[2], last);
      V.positive += centre.positive + last.positive + last.positive;
      V.negative += centre.negative + last.negative + last.negative;
    }
    pairs[kMsldBands - 1][0].add(V.positive);
    pairs[kMsldBands - 1][1].add(V.negative);
  }
  for (std::size_t band = 0; band < kMsldBands; ++band)
    for (std::size_t sign = 0; sign < 2; ++sign) pairs[band][sign].move(sign, sums[band]);
}

#endif

// Normalises to unit norm, clips, and normalises again. The output is in units of 1/255.
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
  RegionSums sums{};
  if (inside(region, image))
    sum_region<true>(image, region, sums);
  else
    sum_region<false>(image, region, sums);

  std::array<double, kSums> mean, deviation;
  const double inverse = 1.0 / region.columns;
  for (std::size_t k = 0; k < kSums; ++k) {
    const BandSums& band = sums[k / 4];
    mean[k] = band.first[k % 4] * inverse;
    const double variance = band.second[k % 4] * inverse - mean[k] * mean[k];
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
