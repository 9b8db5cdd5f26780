// SPDX-License-Identifier: Apache-2.0
// Finds images that a sensor delivers again under a later stamp, and a depth stream that has stopped. Drivers
// do this when no new image has come, and so do recordings of streams with different rates. Two exposures of
// a real sensor never give the same bits, because of noise. A fixed, staggered grid of pixels is compared, by
// a 64-bit hash of each image.
//
// False alarms: one pixel in 49 is looked at, so images of a moving camera that agree there have no texture
// to track. Two different grids have the same hash with a probability of 2^-64.
#pragma once

#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/math/se3.hpp"

namespace plvo {

class ColourStream {
 public:
  // Takes in the image of the next frame, whose size was checked. mask: as in Config; masked pixels are not
  // compared.
  void look(const RgbdFrame& frame, GrayView mask = {});
  void forget() { *this = ColourStream(); }
  // Whether the image of the last frame is that of the frame before.
  bool is_repeated() const { return is_repeated_; }

 private:
  bool has_frame_ = false, is_repeated_ = false;
  std::uint64_t hash_ = 0;
};

// A depth image that is repeated for a short time comes from a slower depth camera and is used. If it stays
// for longer while the camera moves, the stream has stopped: the frames are lost until a new image comes.
class DepthStream {
 public:
  // As ColourStream::look(). An image with hardly any readings never counts as repeated.
  void look(const RgbdFrame& frame, GrayView mask = {});
  void forget() { *this = DepthStream(); }
  bool is_repeated() const { return is_repeated_; }
  // Stamp of the image when it came for the first time.
  std::int64_t first_stamp_ns() const { return first_depth_stamp_ns_; }

  // Whether the image is too old for a camera that has moved by this much since the image came for
  // the first time.
  bool is_too_old_for(const Se3& T_current_first) const;
  // Notes that the stream has stopped; this holds until a new image comes.
  void stop() { has_stopped_ = true; }
  void forget_stop() { has_stopped_ = false; }
  bool has_stopped() const { return has_stopped_; }
  Status explain_stop(const char* first_word) const;

 private:
  bool has_frame_ = false, is_repeated_ = false, has_stopped_ = false;
  std::uint64_t hash_ = 0;
  std::int64_t first_ns_ = 0;  // colour's stamp of the frame in which this image came first
  std::int64_t age_ns_ = 0, first_depth_stamp_ns_ = 0;
};

}  // namespace plvo
