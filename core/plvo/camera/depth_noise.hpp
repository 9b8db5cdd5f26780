// SPDX-License-Identifier: Apache-2.0
// Depth noise, equation (2): σ_d = c1 d² + c2 d + c3, d in metres. The paper's coefficients go negative below
// 0.34 m, so σ_d is kept above a floor.
#pragma once

namespace plvo {

struct DepthNoise {
  double c1 = 2.73e-3;  // 1/m
  double c2 = 7.4e-4;
  double c3 = -5.8e-4;    // m
  double floor_m = 5e-4;  // smallest σ_d

  // Depth and colour of a real sensor do not meet exactly: on a slope an error of so many pixels (SD) becomes
  // one of depth. Not in the paper; 0 switches it off.
  double registration_px = 0.5;

  double sigma(double depth_m) const {
    const double sigma_d = (c1 * depth_m + c2) * depth_m + c3;
    return sigma_d > floor_m ? sigma_d : floor_m;
  }
};

// The variances that the residuals show over those that the models state, one factor for each kind of
// measurement: across the image and along the ray for points, all of it for lines and for surfaces; and for
// what all of a frame share (nuisance_parameters.hpp).
struct NoiseScales {
  double image = 1;
  double depth = 1;
  double lines = 1;
  double surfaces = 1;
  double angular_rate = 1;
  double shared_depth = 1;
};

}  // namespace plvo
