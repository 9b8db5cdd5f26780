// SPDX-License-Identifier: Apache-2.0
#include "plvo/base/heap_sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

TEST(HeapSort, SortsLikeStdSort) {
  Random random(1);
  for (std::uint32_t size = 0; size < 300; ++size) {
    std::vector<std::uint32_t> numbers(size);
    // Every third size has many equal numbers.
    for (std::uint32_t& number : numbers) number = random.below(size % 3 == 0 ? 5 : 1000000);
    std::vector<std::uint32_t> expected = numbers;
    std::sort(expected.begin(), expected.end(), std::greater<>());
    heap_sort(numbers.data(), numbers.data() + numbers.size(), std::greater<>());
    EXPECT_EQ(numbers, expected) << size;
  }
}

// The bound holds for every input order: sorted, reversed, all equal, shuffled.
TEST(HeapSort, NumberOfComparisonsStaysWithinTheBound) {
  constexpr int kSize = 1024, kLevels = 10;
  const auto count = [](const auto& make) {
    std::vector<int> numbers(kSize);
    for (int i = 0; i < kSize; ++i) numbers[static_cast<std::size_t>(i)] = make(i);
    int compared = 0;
    heap_sort(numbers.data(), numbers.data() + numbers.size(), [&](int a, int b) {
      ++compared;
      return a < b;
    });
    EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
    return compared;
  };
  constexpr int kBound = 2 * kSize * kLevels + 2 * kSize;
  EXPECT_LE(count([](int i) { return i; }), kBound);
  EXPECT_LE(count([](int i) { return -i; }), kBound);
  EXPECT_LE(count([](int) { return 7; }), kBound);
  EXPECT_LE(count([](int i) { return i * 7919 % kSize; }), kBound);
}

}  // namespace
}  // namespace plvo
