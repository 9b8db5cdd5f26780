// SPDX-License-Identifier: Apache-2.0
// Settings of boxes 5 and 6 of the paper: RANSAC, the joint estimate, and the conditions under which it is
// accepted.
#pragma once

namespace plvo {

struct MotionConfig {
  // Iterations count non-degenerate sets only: iterations ≤ max_ransac_iterations, draws ≤ 4
  // max_ransac_iterations.
  int max_ransac_iterations = 300;
  // The estimate fails with kNoConsensus below this number of inliers of all kinds together.
  int min_inliers = 10;
  // true: Huber's loss in the maximum-likelihood refinement. It is robust where the covariances are too
  // optimistic, and the resulting covariance stays consistent where they are right (robust_kernel.hpp).
  // false: the paper's least squares.
  bool robust = true;
  // The estimate fails with kDegenerate if the SD of the translation (rotation) in its worst direction
  // exceeds this.
  double max_sigma_m = 0.1;
  double max_sigma_rad = 0.1;
};

}  // namespace plvo
