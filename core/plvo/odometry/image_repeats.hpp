// SPDX-License-Identifier: Apache-2.0
// Finds images that a sensor delivers again under a later stamp. Drivers do this when no new image has come,
// and so do recordings of streams with different rates. Two exposures of a real sensor never give the same
// bits, because of noise. A fixed, staggered grid of pixels is compared, by a 64-bit hash of each image.
//
// False alarms: one pixel in 49 is looked at, so images of a moving camera that agree there have no texture
// to track. Two different grids have the same hash with a probability of 2^-64.
#pragma once

#include <cstdint>

#include "plvo/image/frame.hpp"

namespace plvo {

class ImageRepeats {
 public:
  // Takes in the images of the next frame, whose sizes were checked. mask: as in Config; masked pixels are
  // not compared.
  void look(const RgbdFrame& frame, GrayView mask = {});
  void forget() { *this = ImageRepeats(); }

  // Whether the colour image of the last frame, or its depth image, is that of the frame before. A depth
  // image with hardly any reading is never called a repeated one.
  bool colour_is_repeated() const { return colour_is_repeated_; }
  bool depth_is_repeated() const { return depth_is_repeated_; }
  // Time since this depth image came for the first time.
  std::int64_t depth_age_ns() const { return depth_age_ns_; }
  // Stamp of the depth image when it came for the first time.
  std::int64_t depth_stamp_ns() const { return depth_stamp_ns_; }

 private:
  bool has_frame_ = false;
  bool colour_is_repeated_ = false, depth_is_repeated_ = false;
  std::uint64_t colour_hash_ = 0, depth_hash_ = 0;
  std::int64_t depth_first_ns_ = 0;  // colour's stamp of the frame in which this depth image came first
  std::int64_t depth_age_ns_ = 0, depth_stamp_ns_ = 0;
};

}  // namespace plvo
