// SPDX-License-Identifier: Apache-2.0
// The minimum of a criterion that is measured at a few places around it: a quadratic surface through them.
// The criterion is a sum over pieces of a recording, and so are the surface's coefficients; drawing the
// pieces anew, with replacement, tells how far the minimum would have moved with another recording of the
// same kind (the bootstrap, over pieces long enough to be independent).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace plvo::calibrate {

// Where to measure, for one, two or three unknowns: rows are places, in units of the half-width, within ±1.
Eigen::MatrixXd quadratic_design(int unknowns);

struct QuadraticMinimum {
  Eigen::VectorXd place;       // in units of the half-width, never beyond ±kFarthest
  Eigen::MatrixXd covariance;  // of the place
  bool convex = false;         // else the place is the best of those measured, and the covariance is infinite
};
inline constexpr double kFarthest = 2;

// costs: a row for each piece, a column for each place of the design. At least one row.
QuadraticMinimum fit_quadratic(const Eigen::MatrixXd& design, const Eigen::MatrixXd& costs);

}  // namespace plvo::calibrate
