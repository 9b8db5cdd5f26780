// SPDX-License-Identifier: Apache-2.0
// Sub-pixel registration of a matched keypoint: finds the patch of the reference in the current image. The
// detector locates a keypoint in each frame to about half a pixel. Registering the patch of one frame in the
// other measures the difference of the two positions several times more accurately, and the motion depends
// only on that difference. The method is inverse composition (Baker & Matthews, "Lucas-Kanade 20 years on",
// IJCV 2004) with gain and offset of the illumination as unknowns. Each step is one linear regression:
//   I(x + d) ≈ a T(x) + b + ∇T · c,   d ← d − c / a.
//
// Both images are interpolated by the cubic B-spline: T is smoothed by [1 4 1]/6 in both directions, and I is
// read with the spline's four weights at each sub-pixel fraction. Bilinear interpolation would displace fine
// structure by up to 0.02 px, as a sine of that fraction. When the camera rotates, the fraction is nearly the
// same all over the image, so the displacements of all points are correlated and look like a motion (Unser,
// Aldroubi & Eden, "B-spline signal processing", 1993: the spline's transform falls with the fourth power,
// and so does its aliasing).
#pragma once

#include "plvo/image/image_view.hpp"
#include "plvo/math/types.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

struct AlignmentOptions {
  int max_iterations = 8;
  double tolerance_px = 0.02;  // stops when |step| < this
  double max_shift_px = 3;  // limit of the distance from the start; a patch farther away is a different one
  double max_residual = 0.35;  // SD of the residual / SD of the patch, after gain and offset
};

struct Alignment {
  bool ok = false;
  double x = 0, y = 0;  // position in pixels of the level
  // Standard deviation of the position along its worse axis, from the residual and the patch's gradients.
  double sigma_px = 0;
  int iterations = 0;
  int reach = 0;  // pixels of the level around (x, y), along x and along y, within which the image was read
};

// Deformation of the patch since the reference: a pixel at (dx, dy) from its centre is now at W (dx, dy).
struct PatchWarp {
  Matrix2 W = Matrix2::Identity();
  // True if it suffices to move the patch along its gradient, once. For any other warp, the window is read
  // pixel by pixel, which takes six times the instructions in every step.
  bool is_slight() const;
};

// patch: cut around whole pixel (px, py) of the reference's level. Only the pixels of its window in `mask`
// are compared; at least a third of the window must be in it. (start_x, start_y): predicted position of that
// pixel on the same level of the current image. Returns ok = false if the patch is not found.
Alignment align_patch(const Patch& patch, const WindowMask& mask, GrayView image, double start_x,
                      double start_y, const AlignmentOptions& options, const PatchWarp& warp = {});

}  // namespace plvo
