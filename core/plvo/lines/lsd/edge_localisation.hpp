// SPDX-License-Identifier: Apache-2.0
// The position of a segment to a fraction of a pixel, from the full-resolution image. The segment is found
// where the image is small; here up to 32 short profiles across it, along image rows or columns so that no
// pixel is ever interpolated, give the place of steepest change, and a weighted line through them the segment
// and its uncertainty.
#pragma once

#include "plvo/image/image_view.hpp"
#include "plvo/lines/segment.hpp"

namespace plvo::lsd {

// Moves segment across itself, by at most about 3 pixels at either end, and sets its sigma_px and
// sigma_angle_rad. position_sd_px: how well the segment is known so far; what the sigmas are derived from
// where too few profiles (fewer than four, or fewer than half) show an edge of the segment's sign, and the
// segment then stays as it is. Cost: at most 32 profiles of 11 × 3 pixels.
bool localise(GrayView image, double position_sd_px, Segment& segment);

}  // namespace plvo::lsd
