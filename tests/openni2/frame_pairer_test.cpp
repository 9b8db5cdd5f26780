// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/frame_pairer.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <deque>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

void put(FramePairer& pairer, FramePairer::Stream stream, std::int64_t stamp_us) {
  const std::span<std::uint8_t> bytes = pairer.next_buffer(stream);
  std::memcpy(bytes.data(), &stamp_us, sizeof(stamp_us));
  pairer.commit(stream, stamp_us);
}

TEST(FramePairer, PairsWithinTheToleranceOnly) {
  FramePairer pairer;
  pairer.reset(8, 8, 10);
  FramePairer::Pair pair;
  put(pairer, FramePairer::kColour, 100);
  EXPECT_FALSE(pairer.take(pair));
  put(pairer, FramePairer::kDepth, 111);
  EXPECT_FALSE(pairer.take(pair));
  EXPECT_EQ(pairer.unmatched(FramePairer::kColour), 1u);
  EXPECT_EQ(pairer.last_miss_us(), 11);
  put(pairer, FramePairer::kColour, 121);
  ASSERT_TRUE(pairer.take(pair));
  EXPECT_EQ(pair.colour.stamp_us, 121);
  EXPECT_EQ(pair.depth.stamp_us, 111);
}

// Compares the pairer with a brute-force rule on random streams: a colour image belongs to the depth image
// within the tolerance among all images so far, and every image ends in exactly one pair or as unmatched.
TEST(FramePairer, AgreesWithABruteForceRuleOnRandomStreams) {
  constexpr std::int64_t kSpacing = 1000;
  Random random(3);
  FramePairer pairer;
  pairer.reset(8, 8, kSpacing / 2);
  std::deque<std::int64_t> stamps[2];
  std::uint64_t pairs = 0, expected_pairs = 0;
  std::uint64_t images[2] = {0, 0};
  for (int i = 0; i < 5000; ++i) {
    const std::int64_t tick = i * kSpacing;
    // Each stream jitters by up to a quarter of a period and loses every tenth image.
    const std::int64_t stamp[2] = {tick + random.below(250), tick + random.below(250)};
    const bool lost[2] = {random.below(10) == 0, random.below(10) == 0};
    expected_pairs += !lost[0] && !lost[1];
    for (int s = 0; s < 2; ++s) {
      if (lost[s]) continue;
      put(pairer, static_cast<FramePairer::Stream>(s), stamp[s]);
      ++images[s];
    }
    for (FramePairer::Pair pair; pairer.take(pair); ++pairs) {
      EXPECT_LE(std::abs(pair.colour.stamp_us - pair.depth.stamp_us), 250);
      std::int64_t inside = 0;
      std::memcpy(&inside, pair.colour.bytes.data(), sizeof(inside));
      EXPECT_EQ(inside, pair.colour.stamp_us) << "the bytes travel with their stamp";
      pairer.release();
    }
  }
  EXPECT_EQ(pairs, expected_pairs);
  for (const auto s : {FramePairer::kColour, FramePairer::kDepth}) {
    EXPECT_EQ(images[s], pairs + pairer.unmatched(s) + pairer.waiting(s));
  }
}

TEST(FramePairer, FullQueueDropsItsOldestImageButNoBorrowedOne) {
  FramePairer pairer;
  pairer.reset(8, 8, 10);
  FramePairer::Pair pair;
  put(pairer, FramePairer::kColour, 0);
  put(pairer, FramePairer::kDepth, 0);
  ASSERT_TRUE(pairer.take(pair));
  for (std::int64_t i = 1; i <= 30; ++i) put(pairer, FramePairer::kColour, i * 100);
  std::int64_t inside = -1;
  std::memcpy(&inside, pair.colour.bytes.data(), sizeof(inside));
  EXPECT_EQ(inside, 0);
  EXPECT_EQ(pairer.waiting(FramePairer::kColour), FramePairer::kSlots);
  EXPECT_EQ(pairer.unmatched(FramePairer::kColour), 30 - FramePairer::kSlots);
  pairer.release();
  put(pairer, FramePairer::kDepth, 3000);
  ASSERT_TRUE(pairer.take(pair));
  EXPECT_EQ(pair.colour.stamp_us, 3000);
}

}  // namespace
}  // namespace plvo
