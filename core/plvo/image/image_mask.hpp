// SPDX-License-Identifier: Apache-2.0
// Pixels of the camera's images that are not used: a part of the robot in view, burnt-in text. They travel
// with the camera, so what they show contradicts its motion.
//
// The content of masked pixels has no influence: they become grey before the image is undistorted and
// smoothed, and their depth becomes "no depth". The border of the grey area is no edge of the scene, so
// features must keep away from it by the reach of the windows in which they are detected and registered.
// is_free() answers for the undistorted image, from a table of distances: one per block of 4 × 4 pixels. Up
// to 6 px beyond the reach of a masked pixel it may still answer no; within the reach it never answers yes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/image/undistortion.hpp"

namespace plvo {

class ImageMask {
 public:
  // Takes width × height × (2 + 1/16) bytes.
  constexpr void allocate(Arena& memory, int width, int height) {
    distance_ = memory.take<std::uint8_t>("image mask", blocks_along(width) * blocks_along(height));
    depth_ = memory.take<std::uint16_t>("depth without masked pixels",
                                        static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  }

  // used: 0 marks the pixels that are not used. It has the size of the camera's image, is in pixels of the
  // image before undistortion, and must outlive the mask. Without memory or without an image, the mask stays
  // inactive, and all pixels are used.
  void init(GrayView used, const UndistortionMap& map);
  bool active() const { return used_.data != nullptr; }

  // Makes the masked pixels of the camera's image grey. gray: some of its rows, from first_row on.
  void blank(ImageView<std::uint8_t> gray, int first_row) const;
  // The depth image of a frame without the readings of masked pixels. It is a copy, valid until the next
  // call.
  DepthView without_masked(const DepthView& depth) const;

  // Whether no masked pixel lies within reach_px, along x and along y, of pixel (x, y) of the undistorted
  // image.
  bool is_free(int x, int y, int reach_px) const {
    if (!active()) return true;
    const auto column = static_cast<std::size_t>(std::clamp(x, 0, used_.width - 1) / kBlock);
    const auto row = static_cast<std::size_t>(std::clamp(y, 0, used_.height - 1) / kBlock);
    return kBlock * distance_[row * columns_ + column] > reach_px + kBlock - 1;
  }

 private:
  static constexpr int kBlock = 4;  // px
  static constexpr std::size_t blocks_along(int pixels) {
    return static_cast<std::size_t>((pixels + kBlock - 1) / kBlock);
  }
  bool is_masked(const UndistortionMap& map, int x, int y) const;
  void measure_distances();

  GrayView used_;
  // Distance to the nearest block with a masked pixel, in blocks: the larger of that along x and along y.
  std::span<std::uint8_t> distance_;
  std::size_t columns_ = 0, rows_ = 0;
  std::span<std::uint16_t> depth_;
};

// The pixels of level 0 that a window on a level of the pyramid depends on lie within this distance of its
// centre. reach_px: reach of the window, in pixels of its level. Each level is smoothed over two pixels of
// the one before to either side.
constexpr int reach_on_base(int level, int reach_px) { return (reach_px << level) + 2 * ((1 << level) - 1); }

}  // namespace plvo
