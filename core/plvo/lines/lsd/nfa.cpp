// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/nfa.hpp"

#include "plvo/math/trigonometry.hpp"

namespace plvo::lsd {
namespace {

constexpr double kLn7 = 1.94591014905531330511;
constexpr double kLn8 = 2.07944154167983592825;
constexpr double kLog10OfE = 0.43429448190325182765;

}  // namespace

FalseAlarms::FalseAlarms(int width, int height) {
  log10_tests_ = kLog10OfE * 2.5 * (log(width) + log(height));
  for (std::size_t n = 1; n < kTable; ++n) {
    log_factorials_[n] = log_factorials_[n - 1] + log(static_cast<double>(n));
  }
}

double FalseAlarms::log_factorial(int n) const {
  if (n < static_cast<int>(kTable)) return log_factorials_[static_cast<std::size_t>(n)];
  // Stirling's series. From n = 256 on, the first neglected term is below 1e-15.
  const double x = n;
  const double inverse = 1 / x;
  constexpr double kHalfLog2Pi = 0.91893853320467274178;
  return (x + 0.5) * log(x) - x + kHalfLog2Pi +
         inverse * (1.0 / 12 - inverse * inverse * (1.0 / 360 - inverse * inverse * (1.0 / 1260)));
}

double FalseAlarms::meaningfulness(int n, int k) const {
  if (8 * k <= n) return -log10_tests_;
  const double log_first =
      log_factorial(n) - log_factorial(k) - log_factorial(n - k) - k * kLn8 + (n - k) * (kLn7 - kLn8);
  // Each term of the tail is the previous one times a ratio that decreases and is below 1 from k on. The
  // remainder is therefore below a geometric series. There are at most n − k terms, in practice a small
  // multiple of √n.
  constexpr double kOdds = 1.0 / 7;  // p / (1 − p)
  double sum = 1;
  double term = 1;
  for (int j = k; j < n; ++j) {
    const double ratio = (n - j) * kOdds / (j + 1);
    term *= ratio;
    sum += term;
    const double rest = term * ratio / (1 - ratio);
    if (rest < 1e-3 * sum) {
      sum += rest;
      break;
    }
  }
  return -(log10_tests_ + kLog10OfE * (log_first + log(sum)));
}

}  // namespace plvo::lsd
