// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/image_mask.hpp"

namespace plvo {
namespace {

// The middle of the grey levels adds least contrast at the border of the masked area.
constexpr std::uint8_t kMaskedGrey = 128;
constexpr std::uint8_t kFarthest = 255;

}  // namespace

void ImageMask::init(GrayView used, const UndistortionMap& map) {
  if (distance_.empty() || used.data == nullptr) return;
  used_ = used;
  columns_ = blocks_along(used.width);
  rows_ = blocks_along(used.height);
  std::fill(distance_.begin(), distance_.end(), kFarthest);
  for (int y = 0; y < used.height; ++y)
    for (int x = 0; x < used.width; ++x)
      if (is_masked(map, x, y))
        distance_[static_cast<std::size_t>(y / kBlock) * columns_ + static_cast<std::size_t>(x / kBlock)] = 0;
  measure_distances();
}

// Whether an undistorted pixel depends on a masked one. It is interpolated between pixels that are adjacent
// to the nearest one.
bool ImageMask::is_masked(const UndistortionMap& map, int x, int y) const {
  if (!map.active()) return used_.at(x, y) == 0;
  int raw_x = 0;
  int raw_y = 0;
  if (!map.raw_pixel(x, y, raw_x, raw_y)) return false;
  for (int j = std::max(raw_y - 1, 0); j <= std::min(raw_y + 1, used_.height - 1); ++j)
    for (int i = std::max(raw_x - 1, 0); i <= std::min(raw_x + 1, used_.width - 1); ++i)
      if (used_.at(i, j) == 0) return true;
  return false;
}

// One pass from the top left and one from the bottom right suffice for this distance (Rosenfeld & Pfaltz,
// "Sequential operations in digital picture processing", JACM 1966).
void ImageMask::measure_distances() {
  const auto at = [&](std::size_t column, std::size_t row) -> std::uint8_t& {
    return distance_[row * columns_ + column];
  };
  // The block takes the distance of the neighbour plus one, where that is less.
  const auto take = [](std::uint8_t& distance, std::uint8_t beside) {
    if (beside < kFarthest) distance = std::min(distance, static_cast<std::uint8_t>(beside + 1));
  };
  const auto take_row = [&](std::size_t column, std::size_t row, std::size_t beside) {
    if (column > 0) take(at(column, row), at(column - 1, beside));
    take(at(column, row), at(column, beside));
    if (column + 1 < columns_) take(at(column, row), at(column + 1, beside));
  };
  for (std::size_t row = 0; row < rows_; ++row)
    for (std::size_t column = 0; column < columns_; ++column) {
      if (row > 0) take_row(column, row, row - 1);
      if (column > 0) take(at(column, row), at(column - 1, row));
    }
  for (std::size_t row = rows_; row-- > 0;)
    for (std::size_t column = columns_; column-- > 0;) {
      if (row + 1 < rows_) take_row(column, row, row + 1);
      if (column + 1 < columns_) take(at(column, row), at(column + 1, row));
    }
}

void ImageMask::blank(ImageView<std::uint8_t> gray, int first_row) const {
  if (!active()) return;
  for (int y = 0; y < gray.height; ++y) {
    std::uint8_t* const row = gray.row(y);
    const std::uint8_t* const used = used_.row(first_row + y);
    for (int x = 0; x < gray.width; ++x) row[x] = used[x] != 0 ? row[x] : kMaskedGrey;
  }
}

DepthView ImageMask::without_masked(const DepthView& depth) const {
  const ImageView<std::uint16_t> copy{depth_.data(), depth.width, depth.height, depth.width};
  for (int y = 0; y < depth.height; ++y) {
    const std::uint16_t* const from = depth.data + y * depth.stride;
    std::uint16_t* const to = copy.row(y);
    const std::uint8_t* const used = used_.row(y);
    for (int x = 0; x < depth.width; ++x) to[x] = used[x] != 0 ? from[x] : std::uint16_t{0};
  }
  return {copy.data, copy.width, copy.height, copy.stride, depth.metres_per_unit};
}

}  // namespace plvo
