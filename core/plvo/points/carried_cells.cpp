// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/carried_cells.hpp"

#include <algorithm>

namespace plvo {

void CarriedCells::init(int width, int height) {
  forget();
  width_ = width;
  height_ = height;
}

void CarriedCells::forget() {
  votes_.fill(0);
  count_ = told_ = references_ = 0;
  has_light_ = false;
}

bool CarriedCells::take_news() {
  if (count_ <= 2 * told_) return false;
  told_ = count_;
  return true;
}

void CarriedCells::vote(const Counts& stayed, const Counts& moved) {
  const bool fall = ++references_ == kMemory;
  if (fall) references_ = 0;
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    std::uint8_t& vote = votes_[cell];
    if (fall && vote > 0) --vote;
    if (stayed[cell] > moved[cell])
      vote = std::min(static_cast<std::uint8_t>(vote + 1), kMost);
    else if (moved[cell] > 0 && vote > 0)
      --vote;
  }
  count_carried();
}

void CarriedCells::mark_carried(const Counts& stayed, bool is_light) {
  has_light_ = has_light_ || is_light;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      if (stayed[static_cast<std::size_t>(row * kColumns + column)] == 0) continue;
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, kRows - 1); ++y)
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, kColumns - 1); ++x)
          votes_[static_cast<std::size_t>(y * kColumns + x)] = kMost;
    }
  count_carried();
}

std::size_t CarriedCells::cell_of(const Vector2& pixel) const {
  const auto along = [](double at, int cells, int pixels) {
    return static_cast<std::size_t>(std::clamp(at * cells / pixels, 0.0, cells - 1.0));
  };
  return along(pixel.y(), kRows, height_) * kColumns + along(pixel.x(), kColumns, width_);
}

PixelBounds CarriedCells::bounds() const {
  PixelBounds bounds{kColumns, kRows, 0, 0};
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      if (votes_[static_cast<std::size_t>(row * kColumns + column)] < kCarried) continue;
      bounds.left = std::min(bounds.left, column);
      bounds.top = std::min(bounds.top, row);
      bounds.right = std::max(bounds.right, column + 1);
      bounds.bottom = std::max(bounds.bottom, row + 1);
    }
  if (count_ == 0) return {};
  return {bounds.left * width_ / kColumns, bounds.top * height_ / kRows, bounds.right * width_ / kColumns,
          bounds.bottom * height_ / kRows};
}

void CarriedCells::remove_points(PointFeatures& points) const {
  if (count_ == 0) return;
  for (std::size_t i = 0; i < points.keypoints.size(); ++i)
    if (is_carried(points.keypoints[i])) points.points[i] = Point3d();
}

void CarriedCells::count_carried() {
  count_ = static_cast<int>(
      std::count_if(votes_.begin(), votes_.end(), [](std::uint8_t vote) { return vote >= kCarried; }));
  has_light_ = has_light_ && count_ > 0;
}

}  // namespace plvo
