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
  last_x_ = static_cast<std::uint16_t>(((width_ - 1) << kFractionBits) - 1);
  last_y_ = static_cast<std::uint16_t>(((height_ - 1) << kFractionBits) - 1);
  const auto entry_of = [](double position_px, std::uint16_t last) {
    return static_cast<std::uint16_t>(std::clamp(position_px * kScale, 0.0, static_cast<double>(last)));
  };
  for (int y = 0; y < height_; ++y) {
    Entry* row = entries_.data() + static_cast<std::ptrdiff_t>(y) * width_;
    for (int x = 0; x < width_; ++x) {
      const Vector2 raw = distort_pixel(camera, {static_cast<double>(x), static_cast<double>(y)});
      row[x] = {entry_of(raw.x(), last_x_), entry_of(raw.y(), last_y_)};
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
