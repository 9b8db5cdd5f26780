// SPDX-License-Identifier: Apache-2.0
// Removes the lens distortion (assumption a.1 of the paper) with a precomputed map. The map gives, for every
// pixel of the ideal pinhole image, the position in the camera's image. It is an integer polynomial per cell
// of 8×8 pixels, of second order along each axis. For a Kinect's lens, its error is below 1/50 px, and it
// takes a fifth of the memory of a table of all pixels. Depth is registered to colour, so one map serves both
// images. The grey image is resampled as a whole, bilinearly, at positions in 1/128 px. Depth must never be
// blended across an edge; it is read only on demand, at the nearest pixel.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/image/image_view.hpp"

namespace plvo {

class UndistortionMap {
 public:
  static constexpr int kMaxSide = 2047;  // px
  static constexpr int kCell = 8;        // px

  // Takes width × height × ¾ bytes.
  constexpr void allocate(Arena& memory, int width, int height) {
    cells_ = memory.take<Cell>("undistortion map", cells_along(width) * cells_along(height));
  }

  // For a lens without distortion the map stays unused, and the images pass through unchanged.
  void init(const CameraModel& camera);
  bool active() const { return active_; }

  // ideal(x, y) ← raw at the map's position. Pixels that the camera did not see repeat the border of raw. The
  // stride of raw is at most kMaxSide.
  void undistort(GrayView raw, ImageView<std::uint8_t> ideal) const { undistort(raw, ideal, 0, height_); }
  // Undistorts rows begin … end − 1 of ideal.
  void undistort(GrayView raw, ImageView<std::uint8_t> ideal, int begin, int end) const;

  // The position at which the camera imaged ideal pixel (x, y), according to the map. It serves to check the
  // accuracy of the map; undistort() does not use it.
  Vector2 position_px(int x, int y) const {
    const std::int64_t at = position(x, y);
    return Vector2(x_of(at), y_of(at)) / (1 << kFractionBits);
  }

  // The raw pixel nearest to the position at which ideal pixel (x, y) was imaged. False if the camera did not
  // see it.
  bool raw_pixel(int x, int y, int& raw_x, int& raw_y) const {
    if (!active_) {
      raw_x = x;
      raw_y = y;
      return true;
    }
    return nearest(position(x, y), raw_x, raw_y);
  }

  // A linear approximation of the map around pixel (x, y), which must lie in the image. It maps small windows
  // to the raw image. At 3 px from the centre, its error is below 1/20 px for a Kinect's lens.
  class Window {
   public:
    Window(const UndistortionMap& map, int x, int y) : map_(map) {
      if (!map.active_) {
        right_ = std::int64_t{1} << (32 + kFractionBits);
        down_ = 1 << kFractionBits;
        at_ = x * right_ + y * down_;
        return;
      }
      const Cell& c = map.cell(x, y);
      const int i = within_cell(x);
      const int j = within_cell(y);
      at_ = map.position(x, y);
      right_ = c.right + j * c.twist + (kCell / 2 - i) * c.bend_right;
      down_ = c.down + i * c.twist + (kCell / 2 - j) * c.bend_down;
    }
    // Like UndistortionMap::raw_pixel(x + dx, y + dy, …).
    bool raw_pixel(int dx, int dy, int& raw_x, int& raw_y) const {
      const bool seen = map_.nearest(at_ + dx * right_ + dy * down_, raw_x, raw_y);
      return seen || !map_.active_;
    }
    // Maps an offset from the centre, in px, to the raw image: as an offset (step_px) and as a position
    // (position_px).
    Vector2 step_px(const Vector2& step) const {
      constexpr double kUnit = 1.0 / (1 << kFractionBits);
      const double right = kUnit * step.x();
      const double down = kUnit * step.y();
      return {right * x_of(right_) + down * x_of(down_), right * y_of(right_) + down * y_of(down_)};
    }
    Vector2 position_px(const Vector2& step) const {
      return Vector2(x_of(at_), y_of(at_)) / (1 << kFractionBits) + step_px(step);
    }
    // True if a step of 1 px is 1 px in the raw image, too, with a relative error below `share` on each axis.
    bool is_straight(double share) const {
      const auto least = static_cast<std::int32_t>(share * (1 << kFractionBits));
      constexpr std::int32_t kOne = 1 << kFractionBits;
      const auto off = [](std::int32_t x) { return x < 0 ? -x : x; };
      return off(x_of(right_) - kOne) + off(x_of(down_)) < least &&
             off(y_of(down_) - kOne) + off(y_of(right_)) < least;
    }

   private:
    const UndistortionMap& map_;
    std::int64_t at_ = 0, right_ = 0, down_ = 0;
  };

 private:
  static constexpr int kFractionBits = 16;

  // Positions and their derivatives are stored as pairs, x · 2^32 + y, both in 2^-16 px, so one operation
  // serves both. In a cell, the position of the pixel i to the right of and j below the first one is
  //   at + i · right + j · down + i j · twist + B(i) · bend_right + B(j) · bend_down,   B(i) = i (8 − i) / 2.
  struct Cell {
    std::int64_t at, right, down, twist, bend_right, bend_down;
  };
  static constexpr std::int64_t bow(int i) {  // 0 ≤ i ≤ kCell
    return static_cast<std::uint32_t>(i * (kCell - i)) / 2;
  }
  static constexpr std::int32_t x_of(std::int64_t pair) { return static_cast<std::int32_t>(pair >> 32); }
  static constexpr std::int32_t y_of(std::int64_t pair) { return static_cast<std::int32_t>(pair); }

  static constexpr std::size_t cells_along(int pixels) {
    return static_cast<std::size_t>((pixels + kCell - 1) / kCell);
  }
  // The cell of a pixel. Here and in all functions below, the pixel must lie in the image.
  const Cell& cell(int x, int y) const {
    return cells_[static_cast<std::size_t>(y) / kCell * columns_ + static_cast<std::size_t>(x) / kCell];
  }
  static constexpr int within_cell(int x) { return static_cast<int>(static_cast<unsigned>(x) % kCell); }
  std::int64_t position(int x, int y) const { return position(cell(x, y), within_cell(x), within_cell(y)); }
  // Position of a cell's first pixel. The kind in the last bits changes it by at most 2^-16 px. A shifted
  // cell gets the same position as a near one.
  static constexpr std::int64_t place(const Cell& c) { return c.at | (c.at >> 32 & 1); }
  static std::int64_t position(const Cell& c, int i, int j) {
    return place(c) + i * c.right + j * (c.down + i * c.twist) + bow(i) * c.bend_right + bow(j) * c.bend_down;
  }
  bool nearest(std::int64_t at, int& raw_x, int& raw_y) const {
    constexpr std::int32_t kHalf = 1 << (kFractionBits - 1);
    const std::int32_t x = x_of(at);
    const std::int32_t y = y_of(at);
    raw_x = (x + kHalf) >> kFractionBits;
    raw_y = (y + kHalf) >> kFractionBits;
    return static_cast<std::uint32_t>(x - 1) < static_cast<std::uint32_t>(last_x_ - 1) &&
           static_cast<std::uint32_t>(y - 1) < static_cast<std::uint32_t>(last_y_ - 1);
  }
  // True if the rows of a complete cell fit the 16-bit elements.
  bool is_plain(const Cell& c) const;
  // True if, in addition, the pixels have nearly the same arrangement in the raw image. shifted: all of them
  // have the same whole-pixel offset.
  bool is_near(const Cell& c, bool& shifted) const;
  struct NearCell;
  struct PlainStart;

  // These functions process rows first … last − 1 of the cell.
  template <bool kIsShifted>
  static void undistort_near(const Cell& cell, int first, int last, GrayView raw, std::uint8_t* out,
                             std::ptrdiff_t out_stride);
  void undistort_plain(const Cell& cell, int first, int last, GrayView raw, std::uint8_t* out,
                       std::ptrdiff_t out_stride) const;
  void undistort_each(const Cell& cell, int first, int last, GrayView raw, int count, std::uint8_t* out,
                      std::ptrdiff_t out_stride) const;

  std::span<Cell> cells_;
  std::size_t columns_ = 0;
  int width_ = 0;
  int height_ = 0;
  // A bilinear read also touches the next pixel, so the last position is just before the last pixel.
  std::int32_t last_x_ = 0;
  std::int32_t last_y_ = 0;
  bool active_ = false;
};

}  // namespace plvo
