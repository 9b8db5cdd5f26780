// SPDX-License-Identifier: Apache-2.0
// Removes the lens (assumption a.1 of the paper) by a table made once: for every pixel of the ideal pinhole
// image, where the camera imaged it, in 1/32 px. One table serves both images, since depth is registered to
// colour. The grey image is resampled whole, bilinearly; depth must never be blended across an edge and is
// read only where somebody asks, at the nearest pixel.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/camera/camera_model.hpp"
#include "plvo/image/image_view.hpp"

namespace plvo {

class UndistortionTable {
 public:
  static constexpr int kFractionBits = 5;
  static constexpr int kMaxSide = 2047;  // px: a coordinate is 11 + 5 bits

  // Takes width × height × 4 bytes.
  template <typename Memory>
  constexpr void carve(Memory& memory, int width, int height) {
    entries_ = memory.template take<Entry>(
        "undistortion table", static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  }

  // For a lens without distortion the table stays unused and the images pass through untouched.
  void init(const CameraModel& camera);
  bool active() const { return active_; }

  // ideal(x, y) ← raw at the table's position; pixels that the camera did not see repeat its border.
  void undistort(GrayView raw, ImageView<std::uint8_t> ideal) const;

  // The raw pixel nearest to where ideal pixel (x, y) was imaged; false when the camera did not see it.
  bool raw_pixel(int x, int y, int& raw_x, int& raw_y) const {
    if (!active_) {
      raw_x = x;
      raw_y = y;
      return true;
    }
    const Entry& entry = entries_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                  static_cast<std::size_t>(x)];
    constexpr int kHalf = 1 << (kFractionBits - 1);
    raw_x = (entry.x + kHalf) >> kFractionBits;
    raw_y = (entry.y + kHalf) >> kFractionBits;
    return entry.x != 0 && entry.y != 0 && entry.x != last_x_ && entry.y != last_y_;
  }

 private:
  struct Entry {
    std::uint16_t x, y;  // 1/32 px
  };
  // What the camera did not see is entered at the border nearest to it. A bilinear read touches the next
  // pixel too: the last position is just before the last pixel.
  std::span<Entry> entries_;
  int width_ = 0;
  int height_ = 0;
  std::uint16_t last_x_ = 0;
  std::uint16_t last_y_ = 0;
  bool active_ = false;
};

}  // namespace plvo
