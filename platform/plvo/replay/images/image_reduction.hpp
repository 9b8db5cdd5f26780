// SPDX-License-Identifier: Apache-2.0
// Scales colour images down by a whole factor, and their camera model with them: for sensors whose images are
// larger than the core takes, and for boards that are too slow for full images. A pixel becomes the mean of
// the factor × factor pixels that it covers. So noise falls by the factor, and fine texture does not alias
// into moving edges, as it would by leaving out pixels. A whole factor keeps the geometry exact and the sums
// whole numbers. The columns and rows left over on the right and below, fewer than the factor, are cut off.
#pragma once

#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"

namespace plvo {

// The image before scaling: the size in the files.
struct WholeImage {
  int factor = 1;
  int width = 0, height = 0;
};

// The smallest factor that makes images of this size small enough for the core; 1 if they are already.
int least_reduction(int width, int height);

// Returns kInvalidArgument for a factor below 1, or one that leaves images of this size too large for the
// core or makes them too small.
Status check_reduction(int factor, int width, int height);

// Camera model of the scaled images. Pixel (0, 0) is the centre of a pixel: the centre of a small pixel lies
// (factor - 1) / 2 px right of and below that of the first pixel that it covers. The readout between the
// outer rows of the small image takes less time.
CameraModel reduced(const CameraModel& camera, int factor);

// rgb: rows of `width` pixels without gaps; out: out_width × out_height pixels, at most width / factor a row.
void reduce_rgb(const std::uint8_t* rgb, int width, int factor, int out_width, int out_height,
                std::uint8_t* out);

}  // namespace plvo
