// SPDX-License-Identifier: Apache-2.0
// One RGB-D frame. The views are borrowed: they must stay valid until track() returns and are not kept after
// it.
#pragma once

#include <cstdint>

#include "plvo/image/image_view.hpp"

namespace plvo {

struct RgbdFrame {
  std::int64_t stamp_ns = 0;        // of the colour image; strictly increasing
  std::int64_t depth_stamp_ns = 0;  // of the depth image; equal to stamp_ns where the camera does not say
  ColourView colour;
  DepthView depth;
};

}  // namespace plvo
