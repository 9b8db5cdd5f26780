// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/duration_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace plvo::cli {
namespace {

const double kRange = std::log(DurationHistogram::kHighest_ms / DurationHistogram::kLowest_ms);

}  // namespace

void DurationHistogram::add(double ms) {
  const double bins = static_cast<double>(bins_.size());
  const double at = ms > kLowest_ms ? std::log(ms / kLowest_ms) / kRange * bins : 0;
  ++bins_[static_cast<std::size_t>(std::clamp(at, 0.0, bins - 1))];
  ++count_;
  sum_ms_ += ms;
  max_ms_ = std::max(max_ms_, ms);
}

double DurationHistogram::quantile_ms(double q) const {
  if (count_ == 0) return 0;
  const auto wanted = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_)));
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    below += bins_[i];
    if (below < std::max<std::uint64_t>(wanted, 1)) continue;
    const double edge = static_cast<double>(i + 1) / static_cast<double>(bins_.size());
    return std::min(kLowest_ms * std::exp(kRange * edge), max_ms_);
  }
  return max_ms_;
}

}  // namespace plvo::cli
