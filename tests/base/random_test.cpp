// SPDX-License-Identifier: Apache-2.0
#include "plvo/base/random.hpp"

#include <gtest/gtest.h>

#include <array>

namespace plvo {
namespace {

TEST(Random, MatchesThePublishedPcgSequence) {
  // The first outputs that the authors of PCG publish for seed 42, stream 54.
  Random random(42, 54);
  constexpr std::array<std::uint32_t, 6> kExpected{0xa15c02b7, 0x7b47f409, 0xba1d3330,
                                                   0x83d2f293, 0xbfa4784b, 0xcbed606e};
  for (std::uint32_t expected : kExpected) EXPECT_EQ(random.next(), expected);
}

TEST(Random, SequencesDependOnSeedAndStream) {
  Random a(1), b(2), c(1, 2), again(1);
  const std::uint32_t first = a.next();
  EXPECT_NE(first, b.next());
  EXPECT_NE(first, c.next());
  EXPECT_EQ(first, again.next());
}

TEST(Random, BelowIsBoundedAndUniform) {
  Random random(7);
  constexpr std::uint32_t kBins = 7;
  constexpr int kDraws = 70000;
  std::array<int, kBins> count{};
  for (int i = 0; i < kDraws; ++i) {
    const std::uint32_t k = random.below(kBins);
    ASSERT_LT(k, kBins);
    ++count[k];
  }
  double chi_squared = 0;
  constexpr double kExpected = static_cast<double>(kDraws) / kBins;
  for (int n : count) chi_squared += (n - kExpected) * (n - kExpected) / kExpected;
  EXPECT_LT(chi_squared, 22.46) << "99.9 % of a chi-square with 6 degrees of freedom";
  EXPECT_EQ(random.below(1), 0U);
}

TEST(Random, UniformLiesInItsHalfOpenInterval) {
  Random random(3);
  double sum = 0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 4 * 0.2887 / 316.2) << "four standard errors of the mean";
}

}  // namespace
}  // namespace plvo
