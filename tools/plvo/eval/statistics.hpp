// SPDX-License-Identifier: Apache-2.0
// Statistics of a list of errors.
#pragma once

#include <cstddef>
#include <vector>

namespace plvo::eval {

struct Statistics {
  std::size_t count = 0;
  double rmse = 0, mean = 0, median = 0, p90 = 0, p95 = 0, max = 0;  // zero for an empty list
};

Statistics statistics(std::vector<double> values);

// Returns the quantile of a list in increasing order, linear between neighbouring values; fraction in [0, 1];
// zero for an empty list.
double quantile(const std::vector<double>& sorted, double fraction);

}  // namespace plvo::eval
