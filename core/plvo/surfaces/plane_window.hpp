// SPDX-License-Identifier: Apache-2.0
// One sample of a surface: a plane through 7×7 readings of the depth image, every third pixel. In inverse
// depth a plane of the world is one over the image, 1/Z = m · (x, y, 1), and m is its normal over its
// distance.
#pragma once

#include "plvo/image/depth_sampler.hpp"
#include "plvo/surfaces/surface_features.hpp"

namespace plvo {

// The surface that colour pixel (u, v), inside the image, shows. False where nearly all of the window must
// have depth and does not, where it is no plane within the noise (an edge, a curve), or is seen at less than
// about 9°. noise_scale: of the variances, over σ_d² of (2). expected_m: as DepthSampler::locate takes it.
// depth_row, when asked for: where it was read.
bool observe_surface(const DepthSampler& depth, const Pinhole& pinhole, double u, double v,
                     double noise_scale, SurfaceSample& sample, double expected_m = DepthSampler::kUnknown,
                     double* depth_row = nullptr);

}  // namespace plvo
