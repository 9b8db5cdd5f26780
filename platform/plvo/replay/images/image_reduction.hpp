// SPDX-License-Identifier: Apache-2.0
// Colour images made smaller by a whole factor, and the camera that would have taken them: for sensors whose
// images are larger than the core takes, and for boards that are too slow for the whole. A pixel becomes the
// mean of the factor × factor ones that it covers. So every pixel counts: noise falls by the factor, and fine
// texture does not alias into edges that move, as it would if pixels were left out. A whole factor keeps the
// geometry exact, and the sums whole numbers. Columns and rows left over on the right and below, fewer than
// the factor, are cut off.
#pragma once

#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"

namespace plvo {

// What images were scaled down from: the size of the files.
struct WholeImage {
  int factor = 1;
  int width = 0, height = 0;
};

// The smallest factor that makes images of this size small enough for the core: 1 for those that are.
int least_reduction(int width, int height);

// kInvalidArgument for a factor that is none, leaves images of this size too large for the core, or makes
// them too small.
Status check_reduction(int factor, int width, int height);

// Pixel (0, 0) is the centre of a pixel: a small one's middle lies (factor - 1) / 2 px right of and below the
// middle of the first that it covers. A shutter takes less time between the small image's outer rows.
CameraModel reduced(const CameraModel& camera, int factor);

// rgb: rows of `width` pixels without gaps; out: out_width × out_height pixels, at most width / factor a row.
void reduce_rgb(const std::uint8_t* rgb, int width, int factor, int out_width, int out_height,
                std::uint8_t* out);

}  // namespace plvo
