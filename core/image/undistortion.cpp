// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/undistortion.hpp"

#include <algorithm>

namespace plvo {

void UndistortionTable::init(const CameraModel& camera) {
  width_ = camera.width;
  height_ = camera.height;
  active_ = !camera.distortion.is_zero();
  if (!active_) return;
  constexpr double kScale = 1 << kFractionBits;
  for (int y = 0; y < height_; ++y) {
    Entry* row = entries_.data() + static_cast<std::ptrdiff_t>(y) * width_;
    for (int x = 0; x < width_; ++x) {
      const Vector2 raw = distort_pixel(camera, {static_cast<double>(x), static_cast<double>(y)});
      // A bilinear read touches the next pixel too: the last row and column count as outside.
      const bool inside = raw.x() >= 0 && raw.y() >= 0 && raw.x() < width_ - 1 && raw.y() < height_ - 1;
      row[x] = inside ? Entry{static_cast<std::uint16_t>(raw.x() * kScale),
                              static_cast<std::uint16_t>(raw.y() * kScale)}
                      : Entry{kOutside, 0};
      if (inside) continue;
      // Remember the nearest border pixel in y, which has room beside the mark in x.
      const double clamped_y = std::clamp(raw.y(), 0.0, height_ - 1.0);
      row[x].y = static_cast<std::uint16_t>(clamped_y * kScale);
    }
  }
}

void UndistortionTable::undistort(GrayView raw, ImageView<std::uint8_t> ideal) const {
  constexpr std::uint32_t kOne = 1u << kFractionBits;
  constexpr std::uint32_t kMask = kOne - 1;
  for (int y = 0; y < height_; ++y) {
    const Entry* row = entries_.data() + static_cast<std::ptrdiff_t>(y) * width_;
    std::uint8_t* out = ideal.row(y);
    for (int x = 0; x < width_; ++x) {
      const Entry entry = row[x];
      if (entry.x == kOutside) {
        out[x] = raw.at(x < width_ / 2 ? 0 : width_ - 1, entry.y >> kFractionBits);
        continue;
      }
      const std::uint8_t* top =
          raw.data + (entry.y >> kFractionBits) * raw.stride + (entry.x >> kFractionBits);
      const std::uint8_t* bottom = top + raw.stride;
      const std::uint32_t fx = entry.x & kMask;
      const std::uint32_t fy = entry.y & kMask;
      const std::uint32_t above = top[0] * (kOne - fx) + top[1] * fx;
      const std::uint32_t below = bottom[0] * (kOne - fx) + bottom[1] * fx;
      out[x] = static_cast<std::uint8_t>((above * (kOne - fy) + below * fy + kOne * kOne / 2) >>
                                         (2 * kFractionBits));
    }
  }
}

}  // namespace plvo
