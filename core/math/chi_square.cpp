// SPDX-License-Identifier: Apache-2.0
#include "plvo/math/chi_square.hpp"

#include "plvo/math/trigonometry.hpp"

namespace plvo {

double chi_square_cdf(int dof, double x) {
  if (!(x > 0)) return 0;
  if (x > 200) return 1;
  // The series of the regularised incomplete gamma function (Abramowitz & Stegun 6.5.29),
  // P(a, y) = y^a e^-y / Γ(a + 1) · Σ y^n / ((a + 1) … (a + n)), a = dof/2, y = x/2; all its terms are
  // positive.
  const double y = x / 2;
  // y^a / Γ(a + 1), built up from a = 0 (y^0 / Γ(1)) or a = 1/2 (√y / Γ(3/2)) by factors y / a.
  double a = dof % 2 == 0 ? 0 : 0.5;
  double front = dof % 2 == 0 ? 1 : sqrt(y) / (0.5 * sqrt(kPi));
  while (2 * a + 1 < dof) {
    a += 1;
    front *= y / a;
  }
  double term = 1;
  double sum = 1;
  for (int n = 1; n < 500 && term > 1e-17 * sum; ++n) {
    term *= y / (a + n);
    sum += term;
  }
  const double p = front * exp(-y) * sum;
  return p < 1 ? p : 1;
}

double chi_square_quantile(int dof, double probability) {
  double low = 0;
  double high = 100;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (chi_square_cdf(dof, middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace plvo
