// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/chi_square.hpp"

#include <cmath>

namespace plvo::eval {

// Abramowitz & Stegun 26.4.4 and 26.4.5: two more degrees of freedom add the term (x/2)^(k/2) e^(−x/2) /
// Γ(k/2 + 1).
double chi_square_tail(double x, int dof) {
  if (!(x > 0)) return 1;
  const bool odd = dof % 2 != 0;
  double tail = odd ? std::erfc(std::sqrt(x / 2)) : std::exp(-x / 2);
  double half_dof = odd ? 0.5 : 1;
  double log_term = half_dof * std::log(x / 2) - x / 2 - std::lgamma(half_dof + 1);
  for (; 2 * half_dof < dof; half_dof += 1) {
    tail += std::exp(log_term);
    log_term += std::log(x / 2) - std::log(half_dof + 1);
  }
  return tail;
}

double chi_square_quantile(double probability, int dof) {
  double low = 0;
  double high = dof;
  while (chi_square_tail(high, dof) > 1 - probability) high *= 2;
  constexpr int kHalvings = 50;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (chi_square_tail(middle, dof) > 1 - probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace plvo::eval
