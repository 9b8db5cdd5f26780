// SPDX-License-Identifier: Apache-2.0
// What the depths of matched points say about a motion that was estimated from all that they show. In the
// image the points show it by their parallax, which is inversely proportional to their depth. The depth
// itself changes by the motion along the optical axis, whatever is seen there. If what is seen does not lie
// where its depth is measured, as in a mirror, the two contradict each other.
//
// With P' the measured point of the current frame and T P that of the reference, moved by T, a residual is
// z' − (T P)_z. Its weighted mean says how far the scene has moved along the optical axis beyond T. To first
// order (v_z, ω_x, ω_y) of the ⊞-perturbation of T explain all residuals; the test of the three is sharper,
// but where the points lie close together, v_z and the rotations cannot be told apart.
#pragma once

#include "plvo/motion/point_constraints.hpp"

namespace plvo {

struct DepthShift {
  double t_z = 0;          // m, of the motion T: along the current optical axis
  double z = 0;            // m, mean of the residuals: what the depths add to t_z
  double information = 0;  // of z, 1/m²; 0: not determined
  double chi_square = 0;   // of (v_z, ω_x, ω_y): χ²(3) if the depths agree with T
};

// The shift that the inliers say. Its covariance contains the noise of their depths, the correlation of the
// set's residuals, and a smooth error of the depth image with the SD smooth_error_m at 1 m, which grows with
// the square of the depth (NuisanceParameters).
DepthShift depth_shift(const PointConstraints& points, const Se3& T, double smooth_error_m);

}  // namespace plvo
