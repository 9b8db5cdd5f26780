// SPDX-License-Identifier: Apache-2.0
// The chi-square distribution for few degrees of freedom. It serves tests on squared Mahalanobis distances.
#pragma once

namespace plvo {

// P(X ≤ x) for X ~ χ²(dof), with 1 ≤ dof ≤ 12 and x ≥ 0. The absolute error is below 1e-13.
double chi_square_cdf(int dof, double x);

// The x with P(X ≤ x) = probability, for 0 ≤ probability ≤ 1 − 1e-9. The relative error is below 1e-6.
double chi_square_quantile(int dof, double probability);

}  // namespace plvo
