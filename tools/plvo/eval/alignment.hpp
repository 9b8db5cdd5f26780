// SPDX-License-Identifier: Apache-2.0
// Absolute trajectory error after Umeyama's alignment (PAMI 1991) without scale.
#pragma once

#include <vector>

#include "plvo/eval/statistics.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::eval {

// Returns the rigid motion that maps `from` onto `to` with the least sum of squares. Both lists have the same
// length, at least one point.
Se3 align(const std::vector<Vector3>& from, const std::vector<Vector3>& to);

struct AbsoluteError {
  Statistics position_m;
  Se3 T_truth_estimate;  // maps the estimate onto the truth
  // Factor that fits the estimate's lengths to the truth best, and the RMSE with it. 1 if all lengths are 0.
  double scale = 1;
  double scaled_rmse_m = 0;
};
AbsoluteError absolute_trajectory_error(const std::vector<Se3>& estimate, const std::vector<Se3>& truth);

// Returns the error of the zero-motion baseline: the alignment puts its single position at the centroid of
// the truth.
Statistics identity_absolute_error(const std::vector<Se3>& truth);

}  // namespace plvo::eval
