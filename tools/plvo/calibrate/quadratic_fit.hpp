// SPDX-License-Identifier: Apache-2.0
// Fits a quadratic surface to a criterion that is measured at a few places and returns its minimum. The
// criterion is a sum over blocks of a recording, and so are the coefficients of the surface. A bootstrap,
// which draws the blocks anew with replacement, gives the covariance of the minimum; it assumes blocks long
// enough to be independent.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace plvo::calibrate {

// Returns the places to measure, for one, two or three unknowns: one place per row, in units of the
// half-width, within ±1.
Eigen::MatrixXd quadratic_design(int unknowns);

struct QuadraticMinimum {
  Eigen::VectorXd place;       // in units of the half-width, bounded by ±kFarthest
  Eigen::MatrixXd covariance;  // of the place
  bool convex = false;         // false: the place is the best measured one, and the covariance is infinite
};
inline constexpr double kFarthest = 2;

// costs: a row for each block, a column for each place of the design. At least one row.
QuadraticMinimum fit_quadratic(const Eigen::MatrixXd& design, const Eigen::MatrixXd& costs);

}  // namespace plvo::calibrate
