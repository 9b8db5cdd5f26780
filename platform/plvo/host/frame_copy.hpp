// SPDX-License-Identifier: Apache-2.0
// A frame with pixels of its own, in rows without gaps: what lies between a thread that reads a camera and
// one that computes. Its room grows to the largest frame that it has held.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "plvo/image/frame.hpp"

namespace plvo {

class FrameCopy {
 public:
  // Room for frames of so many pixels, three bytes a pixel and depth.
  void reserve(std::size_t pixels);
  void assign(const RgbdFrame& frame);
  const RgbdFrame& frame() const { return frame_; }  // its views end with the next assign()

 private:
  std::vector<std::uint8_t> colour_;
  std::vector<std::uint16_t> depth_;
  RgbdFrame frame_;
};

}  // namespace plvo
