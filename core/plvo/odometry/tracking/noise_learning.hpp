// SPDX-License-Identifier: Apache-2.0
// Learns the scales of the noise models from the residuals of the estimate: variance components, one for
// points across the image, one for their depth, one for lines, one for surfaces. Medians are used, so that
// neither outliers nor the scale itself decide which residuals count. Only the latest reference is used: its
// motion is small, so the residuals show the noise of the measurement and not that of a long motion.
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
#include "plvo/odometry/tracking/noise_scales.hpp"

namespace plvo {

// Median of the squared normalised residuals over that of χ²(dof), for each kind; 1 where there are too few
// residuals. Scratch: see reserve_noise_learning.
NoiseScales residual_scales(const Pinhole& pinhole, const PointConstraints& points,
                            const LineConstraints& lines, const Se3& T_current_reference, Arena& scratch);

// The same ratio for surfaces; 1 without any.
double surface_scale(const SurfaceConstraints& surfaces, const Se3& T_current_reference, Arena& scratch);

// Ratios for the variances of the nuisance parameters: the mean square of each group's parameters plus their
// remaining variance, over the prior's variance (expectation maximisation of a variance component); 1 for a
// group that is not estimated.
void note_nuisance(const NuisanceParameters& shared, const NuisanceEstimate& estimate, NoiseScales& observed);

// The scales before anything is learnt. Plane residuals of real Kinects are half of σ_d (2), so their square
// is a quarter. Without learning the models stay as they are.
NoiseScales initial_scales(const NoiseConfig& config);

// Moves `scales` one step towards what a frame showed; observed is a factor on the scales.
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
