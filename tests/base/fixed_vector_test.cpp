// SPDX-License-Identifier: Apache-2.0
#include "plvo/base/fixed_vector.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numeric>

namespace plvo {
namespace {

TEST(FixedVector, RejectsAndCountsElementsBeyondItsCapacity) {
  std::array<int, 3> storage{};
  FixedVector<int> v{std::span(storage)};
  EXPECT_TRUE(v.empty());
  EXPECT_EQ(v.capacity(), 3U);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(v.push_back(10 + i), i < 3);
  EXPECT_TRUE(v.full());
  EXPECT_EQ(v.size(), 3U);
  EXPECT_EQ(v.dropped(), 2U);
  EXPECT_EQ(storage, (std::array{10, 11, 12})) << "a refused element overwrites nothing";
  v.add_dropped(4);
  EXPECT_EQ(v.dropped(), 6U);
  v.clear();
  EXPECT_TRUE(v.empty());
  EXPECT_EQ(v.dropped(), 0U);
}

TEST(FixedVector, IteratesOverItsElementsOnly) {
  std::array<int, 8> storage{9, 9, 9, 9, 9, 9, 9, 9};
  FixedVector<int> v{std::span(storage)};
  v.push_back(1);
  v.push_back(2);
  EXPECT_EQ(std::accumulate(v.begin(), v.end(), 0), 3);
  EXPECT_EQ(v.span().size(), 2U);
  const FixedVector<int>& constant = v;
  EXPECT_EQ(std::accumulate(constant.begin(), constant.end(), 0), 3);
  EXPECT_EQ(constant.span()[1], 2);
}

TEST(FixedVector, RejectsEveryElementWithoutStorage) {
  FixedVector<int> v;
  EXPECT_FALSE(v.push_back(1));
  EXPECT_EQ(v.dropped(), 1U);
  EXPECT_EQ(v.begin(), v.end());
}

TEST(FixedVector, WorksAtCompileTime) {
  constexpr int sum = [] {
    std::array<int, 2> storage{};
    FixedVector<int> v{std::span<int>(storage)};
    v.push_back(3);
    v.push_back(4);
    v.push_back(5);
    return v[0] + v[1] + static_cast<int>(v.dropped());
  }();
  static_assert(sum == 8);
}

}  // namespace
}  // namespace plvo
