// SPDX-License-Identifier: Apache-2.0
// Does depth lie over colour as it is, or mirrored? Where depth jumps, something nearer ends, and colour
// mostly has an edge. So the contrast of colour is taken within a few pixels of each jump, and at the place
// that the jump would have in an image mirrored left to right, upside down, or both. Over many frames, blocks
// of the image tell independently of each other which of the four fits best.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "plvo/image/frame.hpp"

namespace plvo {

class EdgeAgreement {
 public:
  void add(const RgbdFrame& frame);

  // "mirrored left to right", "upside down" or "turned by 180 degrees", where that fits significantly better
  // than depth as it is: 1.3 times the contrast over all blocks, and the mean of the blocks' ratios is three
  // of its standard errors above zero, over 8 blocks or more. Where colour and depth have nothing in common
  // the latter happens once in a hundred; where depth fits as it is, the mean lies below zero. Empty
  // otherwise.
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
