// SPDX-License-Identifier: Apache-2.0
// The chi-square distribution with few degrees of freedom, for tests on squared Mahalanobis distances.
#pragma once

namespace plvo {

// P(X ≤ x) for X ~ χ²(dof), 1 ≤ dof ≤ 12, x ≥ 0; absolute error below 1e-13.
double chi_square_cdf(int dof, double x);

// The x with P(X ≤ x) = probability, 0 ≤ probability ≤ 1 − 1e-9; relative error below 1e-6.
double chi_square_quantile(int dof, double probability);

}  // namespace plvo
