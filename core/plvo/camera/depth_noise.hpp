// SPDX-License-Identifier: Apache-2.0
// Depth noise, equation (2): σ_d = c1 d² + c2 d + c3, with d in metres. The paper's coefficients give
// negative values below 0.34 m, so σ_d has a lower bound.
#pragma once

namespace plvo {

struct DepthNoise {
  double c1 = 2.73e-3;  // 1/m
  double c2 = 7.4e-4;
  double c3 = -5.8e-4;    // m
  double floor_m = 5e-4;  // smallest σ_d

  // Standard deviation in pixels of the registration between depth and colour. On a slope, a registration
  // error causes a depth error. This term is not in the paper; 0 disables it.
  double registration_px = 0.5;

  double sigma(double depth_m) const {
    const double sigma_d = (c1 * depth_m + c2) * depth_m + c3;
    return sigma_d > floor_m ? sigma_d : floor_m;
  }
};

}  // namespace plvo
