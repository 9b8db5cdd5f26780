// SPDX-License-Identifier: Apache-2.0
// Separable binomial smoothing in integers: the discrete Gaussian with exact weights. Borders repeat the edge
// pixel.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/image/image_view.hpp"

namespace plvo {

// Scratch for both functions: one padded row of 16-bit sums.
constexpr std::span<std::uint16_t> take_smoothing_row(Arena& memory, int width) {
  return memory.take<std::uint16_t>("smoothing row", static_cast<std::size_t>(width) + 16);
}

// out = in ∗ [1 6 15 20 15 6 1]/64 in both directions (σ = 1.22 px). The vertical pass comes first; its
// result is rounded to quarters of a grey level, so that 16 bits suffice. Both images have the same size and
// must not overlap.
void smooth_binomial7(GrayView in, ImageView<std::uint8_t> out, std::span<std::uint16_t> row_sums);

// Next pyramid level: in ∗ [1 4 6 4 1]/16 in both directions, keeping every second pixel of every second row.
// Pixel (x, y) of the result is centred on pixel (2x, 2y) of the input. out is (w+1)/2 × (h+1)/2.
void halve_binomial5(GrayView in, ImageView<std::uint8_t> out, std::span<std::uint16_t> row_sums);

}  // namespace plvo
