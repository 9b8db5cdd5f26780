// SPDX-License-Identifier: Apache-2.0
// One RGB-D frame. The views are borrowed: they must stay valid until track() returns and are not used
// afterwards.
#pragma once

#include <cstdint>

#include "plvo/image/image_view.hpp"

namespace plvo {

struct RgbdFrame {
  std::int64_t stamp_ns = 0;  // stamp of the colour image; strictly increasing
  std::int64_t depth_stamp_ns =
      0;  // stamp of the depth image; equal to stamp_ns if the camera does not provide one
  ColourView colour;
  DepthView depth;
};

}  // namespace plvo
