// SPDX-License-Identifier: Apache-2.0
// Localises a segment to a fraction of a pixel in the full-resolution image, after detection in a reduced
// image. Up to 32 short profiles across the segment give the position of the steepest change. The profiles
// follow image rows or columns, so no pixel is interpolated. A weighted line fit through these positions
// gives the segment and its uncertainty.
#pragma once

#include "plvo/image/image_view.hpp"
#include "plvo/lines/segment.hpp"

namespace plvo::lsd {

// Moves the segment across itself, by at most 1.5 px along a profile at either end, and sets its sigma_px and
// sigma_angle_rad. position_sd_px: the uncertainty of the segment's position before. Returns false if too few
// profiles (fewer than four, or fewer than half) show an edge of the segment's sign, or if the shift is too
// large. The segment then stays in place, and the sigmas follow from position_sd_px. Cost: at most 32
// profiles of 11 × 3 pixels.
bool localise(GrayView image, double position_sd_px, Segment& segment);

}  // namespace plvo::lsd
