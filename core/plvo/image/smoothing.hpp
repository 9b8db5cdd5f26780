// SPDX-License-Identifier: Apache-2.0
// Binomial smoothing, separable, in integers: the discrete Gaussian with exact weights. Borders repeat the
// edge pixel.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/image/image_view.hpp"

namespace plvo {

// Scratch of both functions: one row of 16-bit sums and its padding.
constexpr std::span<std::uint16_t> take_smoothing_row(Arena& memory, int width) {
  return memory.take<std::uint16_t>("smoothing row", static_cast<std::size_t>(width) + 16);
}

// out = in ∗ [1 6 15 20 15 6 1]/64 in both directions (σ = 1.22 px), down first and rounded to quarters of a
// grey level, so that 16 bits suffice. Same size, not in place.
void smooth_binomial7(GrayView in, ImageView<std::uint8_t> out, std::span<std::uint16_t> row_sums);

// Next pyramid level: in ∗ [1 4 6 4 1]/16 in both directions, every second pixel of every second row kept, so
// that pixel (x, y) of the result is centred on pixel (2x, 2y) of the input. out is (w+1)/2 × (h+1)/2.
void halve_binomial5(GrayView in, ImageView<std::uint8_t> out, std::span<std::uint16_t> row_sums);

}  // namespace plvo
