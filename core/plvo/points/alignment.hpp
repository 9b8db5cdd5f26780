// SPDX-License-Identifier: Apache-2.0
// Sub-pixel registration of a matched keypoint: where in the current image is the very patch that the
// reference saw? Detection places a keypoint to about half a pixel in each frame by itself; registering the
// patch of one frame in the other measures their difference, which is all that the motion needs, several
// times better. Inverse composition (Baker & Matthews, "Lucas-Kanade 20 years on", IJCV 2004) with the gain
// and the offset of the light as unknowns, as one linear regression a step: I(x + d) ≈ a T(x) + b + ∇T · c, d
// ← d − c / a.
//
// Both images are compared as the cubic B-spline sees them: T smoothed by [1 4 1]/6 either way, I by the
// spline's four weights at the fraction of a pixel it is read at. Bilinear reading moves fine structure by up
// to 0.02 px, as a sine of that fraction: when the camera turns the fraction is much the same all over the
// image, so all points err together, which looks like a motion (Unser, Aldroubi & Eden, "B-spline signal
// processing", 1993: the spline's transform falls with the fourth power, and with it what aliases).
#pragma once

#include "plvo/image/image_view.hpp"
#include "plvo/math/types.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

struct AlignmentOptions {
  int max_iterations = 8;
  double tolerance_px = 0.02;  // stop when |step| < this
  double max_shift_px = 3;     // from the start; a patch that runs farther is another one
  double max_residual = 0.35;  // SD of the residual / SD of the patch, after gain and offset
};

struct Alignment {
  bool ok = false;
  double x = 0, y = 0;  // pixels of the level
  // SD of the position along its worse axis, from the residual and the patch's gradients.
  double sigma_px = 0;
  int iterations = 0;
};

// How the patch has been deformed since: a pixel (dx, dy) from its centre is now at W (dx, dy) from it.
struct PatchWarp {
  Matrix2 W = Matrix2::Identity();
  // So little that the patch itself is moved along its gradient, once. With any other the window is read
  // pixel by pixel, which takes six times the instructions in every step.
  bool is_slight() const;
};

// patch: cut around whole pixel (px, py) of the reference's level; of its window the pixels in `mask` are
// compared, of which there must be a third at least. (start_x, start_y): where that pixel is expected on the
// same level of the current image.
Alignment align_patch(const Patch& patch, const WindowMask& mask, GrayView image, double start_x,
                      double start_y, const AlignmentOptions& options, const PatchWarp& warp = {});

}  // namespace plvo
