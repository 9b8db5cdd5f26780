// SPDX-License-Identifier: Apache-2.0
// A grey image and its successively halved versions. Position (u, v) on level l is (u, v) · 2^l on level 0.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/image/smoothing.hpp"

namespace plvo {

class Pyramid {
 public:
  static constexpr int kMaxLevels = 4;

  // Takes ≤ 4/3 × width × height bytes.
  constexpr void allocate(Arena& memory, int width, int height) {
    row_sums_ = take_smoothing_row(memory, width);
    for (int level = 0; level < kMaxLevels; ++level) {
      storage_[static_cast<std::size_t>(level)] = memory.take<std::uint8_t>(
          "pyramid", static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
      width = (width + 1) / 2;
      height = (height + 1) / 2;
    }
  }

  // The size must not exceed the allocated one.
  void init(int width, int height) {
    for (std::size_t level = 0; level < kMaxLevels; ++level) {
      levels_[level] = {storage_[level].data(), width, height, width};
      width = (width + 1) / 2;
      height = (height + 1) / 2;
    }
  }

  // Level 0. The caller fills it and then calls build(), which computes the other levels.
  ImageView<std::uint8_t> base() { return levels_[0]; }
  void build() {
    for (std::size_t level = 1; level < kMaxLevels; ++level)
      halve_binomial5(levels_[level - 1], levels_[level], row_sums_);
  }

  GrayView level(int i) const { return levels_[static_cast<std::size_t>(i)]; }

 private:
  std::array<std::span<std::uint8_t>, kMaxLevels> storage_;
  std::array<ImageView<std::uint8_t>, kMaxLevels> levels_;
  std::span<std::uint16_t> row_sums_;
};

}  // namespace plvo
