// SPDX-License-Identifier: Apache-2.0
// Median and percentiles of durations over any length of time in fixed memory: bins whose widths grow with
// the value, so that what comes out is at most 0.8 % above the truth. Sum, count and maximum are exact.
#pragma once

#include <array>
#include <cstdint>

namespace plvo::cli {

class DurationHistogram {
 public:
  static constexpr double kLowest_ms = 0.01, kHighest_ms = 100'000;

  void add(double ms);
  std::uint64_t count() const { return count_; }
  double mean_ms() const { return count_ > 0 ? sum_ms_ / static_cast<double>(count_) : 0; }
  double max_ms() const { return max_ms_; }
  // The smallest bin's upper edge below which the share q (0 … 1) of all durations lies; 0 when
  // there is none.
  double quantile_ms(double q) const;

 private:
  std::array<std::uint64_t, 2048> bins_{};
  std::uint64_t count_ = 0;
  double sum_ms_ = 0, max_ms_ = 0;
};

}  // namespace plvo::cli
