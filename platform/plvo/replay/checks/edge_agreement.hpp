// SPDX-License-Identifier: Apache-2.0
// Tests whether depth fits colour as it is, or mirrored. A jump in depth is the border of a nearer object,
// where colour mostly has an edge. So the contrast of colour is measured within a few pixels of each jump,
// and at the position of the jump in an image mirrored left to right, upside down, or both. Over many frames,
// blocks of the image give independent votes for one of the four.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "plvo/image/frame.hpp"

namespace plvo {

class EdgeAgreement {
 public:
  void add(const RgbdFrame& frame);

  // Returns "mirrored left to right", "upside down" or "turned by 180 degrees" if that fits significantly
  // better than depth as it is. Two conditions must hold over 8 blocks or more: 1.3 times the contrast over
  // all blocks, and a mean of the blocks' ratios that is three of its standard errors above zero. If colour
  // and depth are unrelated, the second holds once in a hundred; if depth fits as it is, the mean is below
  // zero. Returns an empty string otherwise.
  std::string misfit() const;

 private:
  static constexpr int kColumns = 5, kRows = 4;
  enum Place : std::uint8_t { kAsIs, kMirrored, kUpsideDown, kTurned, kPlaceCount };
  struct Block {
    std::uint64_t jumps = 0;
    std::array<double, kPlaceCount> contrast{};  // sums over the jumps
  };

  void add_jump(const RgbdFrame& frame, int x, int y);

  std::array<Block, static_cast<std::size_t>(kColumns* kRows)> blocks_{};
};

}  // namespace plvo
