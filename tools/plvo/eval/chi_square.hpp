// SPDX-License-Identifier: Apache-2.0
// Chi-square distribution with an integer number of degrees of freedom: the distribution of a normalised
// squared error.
#pragma once

namespace plvo::eval {

// Returns the probability that a chi-square variable of `dof` ≥ 1 degrees of freedom exceeds x.
double chi_square_tail(double x, int dof);

// Returns x with chi_square_tail(x, dof) = 1 − probability; 0 < probability < 1.
double chi_square_quantile(double probability, int dof);

}  // namespace plvo::eval
