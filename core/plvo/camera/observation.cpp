// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/observation.hpp"

namespace plvo {

Point3d observe_point(const Pinhole& pinhole, double u, double v, double depth_m, double sigma_p_px,
                      double sigma_d_m, Matrix3* J_P) {
  const double x = (u - pinhole.cx) / pinhole.fx;
  const double y = (v - pinhole.cy) / pinhole.fy;
  const double sx = depth_m / pinhole.fx * sigma_p_px;
  const double sy = depth_m / pinhole.fy * sigma_p_px;
  const double variance_d = sigma_d_m * sigma_d_m;
  Point3d point;
  point.p = {x * depth_m, y * depth_m, depth_m};
  // J_P diag(σ_p², σ_p², σ_d²) J_Pᵀ, expanded: J_P is upper triangular with one dense column.
  point.Sigma << sx * sx + x * x * variance_d, x * y * variance_d, x * variance_d,  //
      x * y * variance_d, sy * sy + y * y * variance_d, y * variance_d,             //
      x * variance_d, y * variance_d, variance_d;
  if (J_P != nullptr)
    *J_P << depth_m / pinhole.fx, 0, x,  //
        0, depth_m / pinhole.fy, y,      //
        0, 0, 1;
  return point;
}

}  // namespace plvo
