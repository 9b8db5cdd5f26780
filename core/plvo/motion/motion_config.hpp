// SPDX-License-Identifier: Apache-2.0
// What a user may set of boxes 5 and 6 of the paper: RANSAC, the joint estimate, and when it is believed.
#pragma once

namespace plvo {

struct MotionConfig {
  double inlier_probability = 0.99;  // of a true match to pass the χ² test, for every kind; 0 < p < 1
  double ransac_confidence = 0.999;  // to have drawn a set of true matches before stopping; 0 < p < 1
  // Non-degenerate sets drawn: iterations ≤ max_ransac_iterations, draws ≤ 4 max_ransac_iterations.
  int max_ransac_iterations = 300;
  // kNoConsensus with fewer inliers than this, all kinds together, or than this share of the usable matches.
  int min_inliers = 10;
  double min_inlier_ratio = 0.1;
  // Huber's loss in the maximum-likelihood refinement: robust where the covariances are too optimistic,
  // honest where they are right (robust_kernel.hpp). false: the paper's least squares.
  bool robust = true;
  // kDegenerate when the SD of the translation (rotation) in its worst direction exceeds this.
  double max_sigma_m = 0.1;
  double max_sigma_rad = 0.1;
};

}  // namespace plvo
