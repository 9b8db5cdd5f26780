// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/undistortion.hpp"

#include <algorithm>
#include <array>

#include "plvo/base/lanes.hpp"
#include "plvo/math/rounding.hpp"

namespace plvo {
namespace {

constexpr int kWeightBits = 7;  // of a position's fraction in the blend
constexpr int kLaneBits = 10;   // of a position's fraction within a row of a cell
constexpr int kLaneShift = 16 - kLaneBits;
constexpr std::int32_t kMaxLane = 12 << kLaneBits;  // times the longest stride still below 2^15

constexpr std::int64_t pair_of(double x, double y) {
  return round_to<std::int64_t>(x * 65536) * (std::int64_t{1} << 32) + round_to<std::int64_t>(y * 65536);
}
std::int64_t pair_of(const Vector2& v) { return pair_of(v.x(), v.y()); }

constexpr std::int16_t to_lane(std::int32_t q16) {
  return static_cast<std::int16_t>((q16 + (1 << (kLaneShift - 1))) >> kLaneShift);
}

// The first bit of a cell's position, 2^-16 px, says that the cell is plain.
constexpr std::int64_t kPlain = 1;

}  // namespace

// Where the pixels of a part of a row are read: the upper left of four, the weights, then the pixels.
struct UndistortionMap::Row {
  static constexpr int kSize = 64;
  alignas(16) std::array<std::int16_t, kSize> fx, fy;
  alignas(32) std::array<std::int32_t, kSize> offset;  // from the cell's base
  alignas(16) std::array<std::uint16_t, kSize> above,
      below;  // two neighbours each, the left one in the low byte
};

void UndistortionMap::init(const CameraModel& camera) {
  width_ = camera.width;
  height_ = camera.height;
  active_ = !camera.distortion.is_zero();
  if (!active_) return;
  columns_ = cells_along(width_);
  last_x_ = ((width_ - 1) << kFractionBits) - 1;
  last_y_ = ((height_ - 1) << kFractionBits) - 1;
  const auto rows = static_cast<int>(cells_along(height_));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < static_cast<int>(columns_); ++column) {
      const auto at = [&](int i, int j) {
        // A lens that leaves the image by more than its own size there is not followed.
        const Vector2 p = distort_pixel(
            camera, {static_cast<double>(kCell * column + i), static_cast<double>(kCell * row + j)});
        return Vector2(std::clamp<double>(p.x(), -kMaxSide, 2 * kMaxSide),
                       std::clamp<double>(p.y(), -kMaxSide, 2 * kMaxSide));
      };
      constexpr int kHalf = kCell / 2;
      constexpr double kSag = 2.0 * static_cast<double>(bow(kHalf));
      const Vector2 a = at(0, 0), b = at(kCell, 0), c = at(0, kCell), d = at(kCell, kCell);
      const Vector2 corners = 0.5 * (a + b + c + d);
      Cell& cell = cells_[static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column)];
      cell = {pair_of(a),
              pair_of((b - a) / kCell),
              pair_of((c - a) / kCell),
              pair_of((d - c - b + a) / (kCell * kCell)),
              pair_of((at(kHalf, 0) + at(kHalf, kCell) - corners) / kSag),
              pair_of((at(0, kHalf) + at(kCell, kHalf) - corners) / kSag)};
      cell.at = (cell.at & ~kPlain) | (is_plain(cell) ? kPlain : 0);
    }
  }
}

bool UndistortionMap::is_plain(const Cell& c) const {
  constexpr std::int32_t kMargin = 1 << (kFractionBits - 5);
  for (int j = 0; j < kCell; ++j) {
    const std::int64_t start = c.at + j * c.down + bow(j) * c.bend_down;
    const std::int64_t right = c.right + j * c.twist;
    for (int i = 0; i < kCell; ++i) {
      const std::int64_t moved = i * right + bow(i) * c.bend_right;
      const std::int32_t x = x_of(start + moved);
      const std::int32_t y = y_of(start + moved);
      if (x < kMargin || y < kMargin || x > last_x_ - kMargin || y > last_y_ - kMargin) return false;
      constexpr std::int32_t kMost = (kMaxLane - (2 << kLaneBits)) << kLaneShift;
      if (std::max({x_of(moved), -x_of(moved), y_of(moved), -y_of(moved)}) > kMost) return false;
    }
  }
  return true;
}

// One row of a plain cell, all eight pixels at once.
std::ptrdiff_t UndistortionMap::locate_plain(const Cell& c, int j, std::ptrdiff_t stride, Row& row,
                                             int first) {
  constexpr Lanes kSteps = {0, 1, 2, 3, 4, 5, 6, 7};
  constexpr Lanes kBows = {bow(0), bow(1), bow(2), bow(3), bow(4), bow(5), bow(6), bow(7)};
  const std::int64_t start = c.at + j * c.down + bow(j) * c.bend_down;
  const std::int64_t right = c.right + j * c.twist;
  const std::int32_t x = x_of(start);
  const std::int32_t y = y_of(start);
  constexpr std::int32_t kFraction = (1 << kFractionBits) - 1;
  constexpr int kToWeight = kLaneBits - kWeightBits;
  constexpr std::int16_t kRound = 1 << (kToWeight - 1);
  const auto x0 = static_cast<std::int16_t>(((x & kFraction) >> kLaneShift) + kRound);
  const auto y0 = static_cast<std::int16_t>(((y & kFraction) >> kLaneShift) + kRound);
  const Lanes lane_x = kSteps * to_lane(x_of(right)) + kBows * to_lane(x_of(c.bend_right)) + x0;
  const Lanes lane_y = kSteps * to_lane(y_of(right)) + kBows * to_lane(y_of(c.bend_right)) + y0;
  constexpr std::int16_t kWeightMask = (1 << kWeightBits) - 1;
  const Lanes fx = (lane_x >> kToWeight) & kWeightMask;
  const Lanes fy = (lane_y >> kToWeight) & kWeightMask;
  const Lanes offset = (lane_y >> kLaneBits) * static_cast<std::int16_t>(stride) + (lane_x >> kLaneBits);
  const auto at = static_cast<std::size_t>(first);
  store(fx, &row.fx[at]);
  store(fy, &row.fy[at]);
  store_wide(offset, &row.offset[at]);
  return (y >> kFractionBits) * stride + (x >> kFractionBits);
}

// One by one, where the camera's border may be near.
std::ptrdiff_t UndistortionMap::locate_clamped(int x, int y, std::ptrdiff_t stride, Row& row,
                                               int first) const {
  const Cell& c = cell(x, y);
  const int j = y % kCell;
  const std::int64_t start = c.at + j * c.down + bow(j) * c.bend_down;
  const std::int64_t right = c.right + j * c.twist;
  for (int i = 0; i < kCell; ++i) {
    const std::int64_t at = start + i * right + bow(i) * c.bend_right;
    const std::int32_t at_x = std::clamp<std::int32_t>(x_of(at), 0, last_x_);
    const std::int32_t at_y = std::clamp<std::int32_t>(y_of(at), 0, last_y_);
    constexpr std::int32_t kFraction = (1 << kFractionBits) - 1;
    constexpr int kToWeight = kFractionBits - kWeightBits;
    const auto k = static_cast<std::size_t>(first + i);
    row.fx[k] = static_cast<std::int16_t>((at_x & kFraction) >> kToWeight);
    row.fy[k] = static_cast<std::int16_t>((at_y & kFraction) >> kToWeight);
    row.offset[k] = static_cast<std::int32_t>((at_y >> kFractionBits) * stride + (at_x >> kFractionBits));
  }
  return 0;
}

void UndistortionMap::gather(const std::uint8_t* base, std::ptrdiff_t stride, Row& row, int first) {
  for (int i = first; i < first + kCell; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const std::uint8_t* above = base + row.offset[k];
    const std::uint8_t* below = above + stride;
    row.above[k] = static_cast<std::uint16_t>(above[0] | above[1] << 8);
    row.below[k] = static_cast<std::uint16_t>(below[0] | below[1] << 8);
  }
}

void UndistortionMap::undistort(GrayView raw, ImageView<std::uint8_t> ideal, int begin, int end) const {
  Row row;
  for (int y = begin; y < end; ++y) {
    for (int block = 0; block < width_; block += Row::kSize) {
      const int size = std::min(Row::kSize, width_ - block);
      for (int i = 0; i < size; i += kCell) {
        const Cell& c = cell(block + i, y);
        const std::uint8_t* base =
            raw.data + ((c.at & kPlain) != 0 ? locate_plain(c, y % kCell, raw.stride, row, i)
                                             : locate_clamped(block + i, y, raw.stride, row, i));
        gather(base, raw.stride, row, i);
      }
      std::uint8_t* out = ideal.row(y) + block;
      for (int i = 0; i < size; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const std::int16_t fx = row.fx[k];
        const auto left = static_cast<std::int16_t>((1 << kWeightBits) - fx);
        const auto above = static_cast<std::int16_t>((row.above[k] & 255) * left + (row.above[k] >> 8) * fx);
        const auto below = static_cast<std::int16_t>((row.below[k] & 255) * left + (row.below[k] >> 8) * fx);
        // The high half of a product of 16 bits: twice it is (below − above) · fy / 2^7, to one bit.
        const auto change = static_cast<std::int16_t>(below - above);
        const auto share = static_cast<std::int16_t>(row.fy[k] << (15 - kWeightBits));
        const auto half = static_cast<std::int16_t>((change * share) >> 16);
        out[i] = static_cast<std::uint8_t>(
            static_cast<std::int16_t>(above + 2 * half + (1 << (kWeightBits - 1))) >> kWeightBits);
      }
    }
  }
}

}  // namespace plvo
