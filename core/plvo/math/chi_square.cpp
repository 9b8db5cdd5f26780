// SPDX-License-Identifier: Apache-2.0
#include "plvo/math/chi_square.hpp"

#include "plvo/math/trigonometry.hpp"

namespace plvo {

namespace {

// y^a e^-y / Γ(a + 1) with a = dof/2 and y = x/2. The density and the distribution function share this
// factor.
double front(int dof, double y) {
  // Starts at a = 0 (y^0 / Γ(1)) or a = 1/2 (√y / Γ(3/2)) and multiplies by y / a.
  double a = dof % 2 == 0 ? 0 : 0.5;
  double value = dof % 2 == 0 ? 1 : sqrt(y) / (0.5 * sqrt(kPi));
  while (2 * a + 1 < dof) {
    a += 1;
    value *= y / a;
  }
  return value * exp(-y);
}

}  // namespace

double chi_square_cdf(int dof, double x) {
  if (!(x > 0)) return 0;
  if (x > 200) return 1;
  // Series of the regularised incomplete gamma function (Abramowitz & Stegun 6.5.29), P(a, y) = y^a e^-y /
  // Γ(a + 1) · Σ y^n / ((a + 1) … (a + n)). All its terms are positive.
  const double y = x / 2;
  double term = 1;
  double sum = 1;
  for (int n = 1; n < 500 && term > 1e-17 * sum; ++n) {
    term *= y / (0.5 * dof + n);
    sum += term;
  }
  const double p = front(dof, y) * sum;
  return p < 1 ? p : 1;
}

double chi_square_quantile(int dof, double probability) {
  double low = 0;
  double high = 100;
  double x = 2.5 * dof;
  for (int i = 0; i < 60; ++i) {
    const double error = chi_square_cdf(dof, x) - probability;
    (error < 0 ? low : high) = x;
    // Newton's step, with the density front · a / y / 2. A step that leaves the bracket is replaced by
    // bisection.
    const double density = front(dof, x / 2) * dof / (2 * x);
    const double next = density > 0 ? x - error / density : low;
    const double previous = x;
    x = next > low && next < high ? next : 0.5 * (low + high);
    const double change = x - previous;
    if (change * change <= 1e-18 * x * x) break;
  }
  return x;
}

}  // namespace plvo
