// SPDX-License-Identifier: Apache-2.0
// Absolute trajectory error after Umeyama's alignment (PAMI 1991) without scale.
#pragma once

#include <vector>

#include "plvo/eval/statistics.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::eval {

// The rigid motion that brings `from` onto `to` with the least sum of squares. One length, at least one
// point.
Se3 align(const std::vector<Vector3>& from, const std::vector<Vector3>& to);

struct AbsoluteError {
  Statistics position_m;
  Se3 T_truth_estimate;  // brings the estimate onto the truth
  // What the estimate's lengths would have to be multiplied by to fit the truth best, and the RMSE then. 1
  // where there is no length.
  double scale = 1;
  double scaled_rmse_m = 0;
};
AbsoluteError absolute_trajectory_error(const std::vector<Se3>& estimate, const std::vector<Se3>& truth);

// What a camera that never moves scores: its one position is best put at the truth's centre.
Statistics identity_absolute_error(const std::vector<Se3>& truth);

}  // namespace plvo::eval
