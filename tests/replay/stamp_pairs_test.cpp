// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/index/stamp_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

TEST(Associate, TakesTheBestPairsFirstAndEachImageOnce) {
  // 10 and 12 are both near 11: the nearer one (12 → 11.9) wins, and 10 takes the remaining one.
  const auto pairs = associate({10, 12, 30}, {9, 11, 50}, 3);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0], (std::pair<std::size_t, std::size_t>(0, 0)));
  EXPECT_EQ(pairs[1], (std::pair<std::size_t, std::size_t>(1, 1)));
  EXPECT_TRUE(associate({10}, {14}, 3).empty());
  EXPECT_EQ(associate({10}, {13}, 3).size(), 1u);  // a difference equal to the tolerance still pairs
}

// All stamps are within the tolerance of each other: an algorithm over all pairs has 4e10 candidates.
TEST(Associate, AWideToleranceCostsNoMore) {
  constexpr std::int64_t kImages = 200'000;  // 4e10 candidates
  std::vector<std::int64_t> first, second;
  for (std::int64_t i = 0; i < kImages; ++i) {
    first.push_back(i * 33);
    second.push_back(i * 33 + 5);
  }
  const auto pairs = associate(first, second, std::numeric_limits<std::int64_t>::max());
  ASSERT_EQ(pairs.size(), first.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) ASSERT_EQ(pairs[i], (std::pair(i, i)));
}

TEST(Associate, HandlesTheWholeRangeOfStamps) {
  constexpr std::int64_t kLow = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kHigh = std::numeric_limits<std::int64_t>::max();
  EXPECT_TRUE(associate({kLow}, {kHigh}, kHigh).empty());
  EXPECT_EQ(associate({kLow, kHigh - 1}, {kLow + 3, kHigh}, 3).size(), 2u);
  EXPECT_TRUE(associate({1}, {1}, -1).empty());
  EXPECT_TRUE(associate({}, {1}, 5).empty());
}

// Exhaustive search: repeatedly takes the closest of all remaining pairs.
TEST(Associate, EqualsExhaustiveSearch) {
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    // The tolerance ranges from few candidates to all.
    const std::int64_t tolerance = round % 4 == 0 ? 100 : round % 7;
    std::vector<std::int64_t> a, b;
    for (std::int64_t t = 0; t < 60;) a.push_back(t += 1 + static_cast<std::int64_t>(random.below(6)));
    for (std::int64_t t = 0; t < 60;) b.push_back(t += 1 + static_cast<std::int64_t>(random.below(6)));
    std::vector<std::pair<std::size_t, std::size_t>> expected;
    std::vector<bool> used_a(a.size()), used_b(b.size());
    while (true) {
      std::int64_t best = std::numeric_limits<std::int64_t>::max();
      std::pair<std::size_t, std::size_t> choice;
      for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j)
          if (const std::int64_t d = std::abs(a[i] - b[j]);
              !used_a[i] && !used_b[j] && d <= tolerance && d < best) {
            best = d;
            choice = {i, j};
          }
      if (best == std::numeric_limits<std::int64_t>::max()) break;
      used_a[choice.first] = used_b[choice.second] = true;
      expected.push_back(choice);
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(associate(a, b, tolerance), expected);
  }
}

}  // namespace
}  // namespace plvo
