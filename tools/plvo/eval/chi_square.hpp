// SPDX-License-Identifier: Apache-2.0
// The chi-square distribution of whole degrees of freedom: what a normalised squared error should be like.
#pragma once

namespace plvo::eval {

// The probability that a chi-square variable of `dof` ≥ 1 degrees of freedom exceeds x.
double chi_square_tail(double x, int dof);

// x with chi_square_tail(x, dof) = 1 − probability, for probabilities strictly between 0 and 1.
double chi_square_quantile(double probability, int dof);

}  // namespace plvo::eval
