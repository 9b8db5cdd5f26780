// SPDX-License-Identifier: Apache-2.0
// Finds the reference's samples of surfaces in the current frame's depth image, where the motion puts them
// (projective association: Blais & Levine, 1995): on a surface it does not matter where along it that is.
#pragma once

#include <span>

#include "plvo/base/fixed_vector.hpp"
#include "plvo/image/depth_sampler.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/motion/surface_constraints.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/surfaces/surface_features.hpp"

namespace plvo {

// depth: with the exposure of the current frame. reference: at its mid-exposure. Those whose place shows no
// surface, one that faces elsewhere, or one too far off have no match.
void track_surfaces(const DepthSampler& depth, const Pinhole& pinhole, const NoiseConfig& config,
                    double noise_scale, std::span<const SurfaceSample> reference,
                    const Se3& T_current_reference, FixedVector<SurfaceMatch>& matches);

}  // namespace plvo
