// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace plvo::eval {

double quantile(const std::vector<double>& sorted, double fraction) {
  if (sorted.empty()) return 0;
  const double position = fraction * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

Statistics statistics(std::vector<double> values) {
  Statistics result;
  result.count = values.size();
  if (values.empty()) return result;
  std::sort(values.begin(), values.end());
  double sum = 0;
  double squares = 0;
  for (double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<double>(values.size());
  result.mean = sum / count;
  result.rmse = std::sqrt(squares / count);
  result.median = quantile(values, 0.5);
  result.p90 = quantile(values, 0.9);
  result.p95 = quantile(values, 0.95);
  result.max = values.back();
  return result;
}

}  // namespace plvo::eval
