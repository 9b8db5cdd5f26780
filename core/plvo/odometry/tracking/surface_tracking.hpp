// SPDX-License-Identifier: Apache-2.0
// Finds the surface samples of the reference in the current frame's depth image, at the positions that the
// motion predicts (projective association: Blais & Levine, 1995). The position along the surface does not
// matter.
#pragma once

#include <span>

#include "plvo/base/fixed_vector.hpp"
#include "plvo/image/depth_sampler.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/motion/surface_constraints.hpp"
#include "plvo/surfaces/surface_features.hpp"

namespace plvo {

// depth: with the exposure of the current frame. reference: at its mid-exposure. A sample has no match if
// there is no surface at its position, or one with another orientation, or one too far off.
void track_surfaces(const DepthSampler& depth, const Pinhole& pinhole, double noise_scale,
                    std::span<const SurfaceSample> reference, const Se3& T_current_reference,
                    FixedVector<SurfaceMatch>& matches);

}  // namespace plvo
