// SPDX-License-Identifier: Apache-2.0
// The scales of the noise models, which noise_learning.hpp learns.
#pragma once

namespace plvo {

// Ratios of the observed variance of the residuals to the modelled variance, one factor per kind of
// measurement: points across the image and along the ray, lines, surfaces, and the nuisance parameters that
// all measurements of a frame share (nuisance_parameters.hpp).
struct NoiseScales {
  double image = 1;
  double depth = 1;
  double lines = 1;
  double surfaces = 1;
  double angular_rate = 1;
  double shared_depth = 1;
};

}  // namespace plvo
