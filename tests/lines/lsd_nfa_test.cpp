// SPDX-License-Identifier: Apache-2.0
// Compares the number of false alarms with the explicit binomial sum in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "plvo/base/random.hpp"
#include "plvo/lines/lsd/nfa.hpp"

namespace plvo::lsd {
namespace {

// Infinite where the terms are so small that long double loses digits; on some processors it is as short as
// double.
long double reference(int width, int height, int n, int k) {
  constexpr long double p = 1.0L / 8;
  long double sum = 0;
  for (int j = n; j >= k; --j) {
    sum += std::exp(std::lgamma(n + 1.0L) - std::lgamma(j + 1.0L) - std::lgamma(n - j + 1.0L) +
                    j * std::log(p) + (n - j) * std::log1p(-p));
  }
  using Limits = std::numeric_limits<long double>;
  if (!(sum > Limits::min() / Limits::epsilon())) return Limits::infinity();
  const long double tests = std::pow(static_cast<long double>(width) * height, 2.5L);
  return -(std::log10(tests) + std::log10(sum));
}

TEST(FalseAlarms, AgreesWithTheExplicitSum) {
  Random random(5);
  const FalseAlarms alarms(320, 240);
  int compared[2] = {};
  for (int trial = 0; trial < 3000; ++trial) {
    const int n = 1 + static_cast<int>(random.below(trial % 3 == 0 ? 2000 : 120));
    const int k = static_cast<int>(random.below(static_cast<std::uint32_t>(n + 1)));
    const double found = alarms.meaningfulness(n, k);
    const long double truth = reference(320, 240, n, k);
    if (std::isinf(truth)) continue;
    ++compared[8 * k > n ? 1 : 0];
    if (8 * k > n) {
      // The number of false alarms is rounded up by at most one part in a thousand, and never down.
      EXPECT_LE(found, static_cast<double>(truth) + 1e-8) << n << " " << k;
      EXPECT_GE(found, static_cast<double>(truth) - 0.002) << n << " " << k;
    } else {
      EXPECT_LE(found, static_cast<double>(truth) + 1e-8);
      EXPECT_LT(found, 0);
    }
  }
  EXPECT_GT(std::min(compared[0], compared[1]), 100);
}

TEST(FalseAlarms, MeaningfulnessGrowsWithAlignedPixels) {
  const FalseAlarms alarms(320, 240);
  for (int n : {20, 255, 256, 300, 70000}) {
    double before = alarms.meaningfulness(n, 0);
    for (int k = 1; k <= n; k += 1 + n / 100) {
      const double now = alarms.meaningfulness(n, k);
      EXPECT_GE(now, before);
      before = now;
    }
    EXPECT_TRUE(std::isfinite(before));
  }
}

TEST(FalseAlarms, FourteenAlignedPixelsAreJustMeaningful) {
  // (320 · 240)^2.5 = 10^12.21, so 14 aligned pixels of 14 at p = 1/8 are just meaningful, and 13 of 13 are
  // not.
  const FalseAlarms alarms(320, 240);
  EXPECT_GT(alarms.meaningfulness(14, 14), 0);
  EXPECT_LT(alarms.meaningfulness(13, 13), 0);
}

}  // namespace
}  // namespace plvo::lsd
