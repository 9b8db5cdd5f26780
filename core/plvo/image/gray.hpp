// SPDX-License-Identifier: Apache-2.0
// Colour to grey: ITU-R BT.601 luma in integers, (77 R + 150 G + 29 B + 128) / 256.
#pragma once

#include <cstdint>

#include "plvo/image/image_mask.hpp"
#include "plvo/image/image_view.hpp"

namespace plvo {

// Both images have the same size. Grey input is copied.
void to_gray(const ColourView& colour, ImageView<std::uint8_t> gray);

// Mean grey level, 0 … 255, over every fourth row and column; without masked pixels.
double mean_brightness(GrayView gray, const ImageMask& mask = {});

}  // namespace plvo
