// SPDX-License-Identifier: Apache-2.0
// A surface sample: a plane fitted to 7×7 readings of the depth image, every third pixel. In inverse depth, a
// plane in the world is a plane over the image: 1/Z = m · (x, y, 1), where m is its normal divided by its
// distance. A missing reading is replaced by one of the eight pixels around its place, at that pixel's
// position.
#pragma once

#include "plvo/image/depth_sampler.hpp"
#include "plvo/surfaces/surface_features.hpp"

namespace plvo {

// Observes the surface at colour pixel (u, v), which must be inside the image. Returns false unless
// nearly all readings of the window have depth and fit a plane within the noise (no edge, no curve), and the
// surface is seen at more than about 9°. noise_scale: factor of the variances over σ_d² of (2).
// expected_m: as in DepthSampler::locate. depth_row, if given, receives the row of the depth image that was
// read.
bool observe_surface(const DepthSampler& depth, const Pinhole& pinhole, double u, double v,
                     double noise_scale, SurfaceSample& sample, double expected_m = DepthSampler::kUnknown,
                     double* depth_row = nullptr);

}  // namespace plvo
