// SPDX-License-Identifier: Apache-2.0
// Removes the lens (assumption a.1 of the paper) by a map made once: for every pixel of the ideal pinhole
// image, where the camera imaged it. The map is a polynomial for each cell of 8×8 pixels, in integers: of
// second order along either side, off by less than 1/50 px for a Kinect's lens, in a fifth of the memory that
// a table of all pixels takes. One map serves both images, since depth is registered to colour. The grey
// image is resampled whole, bilinearly, at positions in 1/128 px; depth must never be blended across an edge
// and is read only where somebody asks, at the nearest pixel.
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

  // For a lens without distortion the map stays unused and the images pass through untouched.
  void init(const CameraModel& camera);
  bool active() const { return active_; }

  // ideal(x, y) ← raw at the map's position; pixels that the camera did not see repeat its border. raw's
  // stride is at most kMaxSide.
  void undistort(GrayView raw, ImageView<std::uint8_t> ideal) const { undistort(raw, ideal, 0, height_); }
  // Of ideal the rows from begin to before end.
  void undistort(GrayView raw, ImageView<std::uint8_t> ideal, int begin, int end) const;

  // Where the map says that ideal pixel (x, y) was imaged. The images are read without it: it is there for
  // who wants to know how exact the map is.
  Vector2 position_px(int x, int y) const {
    const std::int64_t at = position(x, y);
    return Vector2(x_of(at), y_of(at)) / (1 << kFractionBits);
  }

  // The raw pixel nearest to where ideal pixel (x, y) was imaged; false when the camera did not see it.
  bool raw_pixel(int x, int y, int& raw_x, int& raw_y) const {
    if (!active_) {
      raw_x = x;
      raw_y = y;
      return true;
    }
    return nearest(position(x, y), raw_x, raw_y);
  }

  // The map around one pixel as a plane: where a small window, whose centre (x, y) lies in the image, was
  // imaged. At 3 px from the centre it is off by less than 1/20 px for a Kinect's lens.
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
    // As raw_pixel(x + dx, y + dy, …).
    bool raw_pixel(int dx, int dy, int& raw_x, int& raw_y) const {
      const bool seen = map_.nearest(at_ + dx * right_ + dy * down_, raw_x, raw_y);
      return seen || !map_.active_;
    }
    // So many px from the centre, on the way to the raw image: how far, and to where.
    Vector2 step_px(const Vector2& step) const {
      constexpr double kUnit = 1.0 / (1 << kFractionBits);
      const double right = kUnit * step.x();
      const double down = kUnit * step.y();
      return {right * x_of(right_) + down * x_of(down_), right * y_of(right_) + down * y_of(down_)};
    }
    Vector2 position_px(const Vector2& step) const {
      return Vector2(x_of(at_), y_of(at_)) / (1 << kFractionBits) + step_px(step);
    }
    // So many px are so many of the raw image, each off by less than this share.
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

  // Positions and their derivatives come in pairs, x · 2^32 + y, both in 2^-16 px: every step serves both. In
  // a cell, i pixels to the right and j down from its first one:
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
  // Of a pixel in the image, as is all that follows.
  const Cell& cell(int x, int y) const {
    return cells_[static_cast<std::size_t>(y) / kCell * columns_ + static_cast<std::size_t>(x) / kCell];
  }
  static constexpr int within_cell(int x) { return static_cast<int>(static_cast<unsigned>(x) % kCell); }
  std::int64_t position(int x, int y) const { return position(cell(x, y), within_cell(x), within_cell(y)); }
  // A cell's first pixel: its kind, which the last bits say, moves it by no more than 2^-16 px, and a shifted
  // one as a near one.
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
  // Do the rows of a whole cell fit the 16-bit lanes?
  bool is_plain(const Cell& c) const;
  // Besides, is it read nearly as it lies? And all of it as many whole pixels away?
  bool is_near(const Cell& c, bool& shifted) const;
  struct NearCell;
  struct PlainStart;

  // The cell's rows from first to before last.
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
  // A bilinear read touches the next pixel too: the last position is just before the last pixel.
  std::int32_t last_x_ = 0;
  std::int32_t last_y_ = 0;
  bool active_ = false;
};

}  // namespace plvo
