// SPDX-License-Identifier: Apache-2.0
// How far the models of the noise are right, from the residuals that the estimate leaves: variance
// components, one for points across the image, one for their depth, one for lines, one for surfaces. Medians,
// so that neither outliers nor the scale itself decide who has a say; over the last reference, whose motion
// is small: what shows is the measurement's noise and not that of a long way.
#pragma once

#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/depth_noise.hpp"
#include "plvo/motion/line_constraints.hpp"
#include "plvo/motion/nuisance_parameters.hpp"
#include "plvo/motion/point_constraints.hpp"
#include "plvo/motion/surface_constraints.hpp"
#include "plvo/odometry/config.hpp"

namespace plvo {

// Median of the squared normalised residuals over that of χ²(dof), for each kind; 1 where there are too few
// to tell. Scratch: see reserve_noise_learning.
NoiseScales residual_scales(const Pinhole& pinhole, const PointConstraints& points,
                            const LineConstraints& lines, const Se3& T_current_reference, Arena& scratch);

// The same of surfaces; 1 without any.
double surface_scale(const SurfaceConstraints& surfaces, const Se3& T_current_reference, Arena& scratch);

// What the shared errors' estimate says of their variances: the mean square of each kind's parameters, with
// what is not known of them, over the prior's (expectation maximisation of a variance component); 1 for a
// kind that there is not.
void note_nuisance(const NuisanceParameters& shared, const NuisanceEstimate& estimate, NoiseScales& observed);

// One step of `scales` towards what a frame showed, observed times the scales themselves.
void learn(const NoiseConfig& config, const NoiseScales& observed, NoiseScales& scales);

constexpr void reserve_noise_learning(Arena& memory, const Limits& limits) {
  const ScratchScope scope(memory);
  const auto points = static_cast<std::size_t>(limits.keypoints);
  memory.take<double>("residuals", points);
  memory.take<double>("residuals", points);
  memory.take<double>("residuals", static_cast<std::size_t>(limits.segments));
  if (limits.surfaces > 0) memory.take<double>("residuals", static_cast<std::size_t>(limits.surfaces));
}

}  // namespace plvo
