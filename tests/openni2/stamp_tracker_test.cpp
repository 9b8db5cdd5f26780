// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/stamp_tracker.hpp"

#include <gtest/gtest.h>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kPeriod = 33333;

TEST(StampTracker, KeepsTheStampsOfAGoodClock) {
  StampTracker tracker;
  tracker.reset(kPeriod, true);
  for (int i = 0; i < 100; ++i) {
    for (int s = 0; s < 2; ++s) {
      const auto result = tracker.map(s, 1000 + i * kPeriod + s * 4000, 5000000 + i * kPeriod);
      EXPECT_EQ(result.stamp_us, 1000 + i * kPeriod + s * 4000);
      EXPECT_EQ(result.step, StampTracker::Step::kForward);
    }
  }
}

// One hour of a Kinect: 50 wraps of its counter, with one stream always slightly ahead of the other.
TEST(StampTracker, WrapsAreExactForAnHour) {
  StampTracker tracker;
  tracker.reset(kPeriod, true);
  int wraps[2] = {0, 0};
  for (std::int64_t i = 0; i < 108000; ++i) {
    for (int s = 0; s < 2; ++s) {
      const std::int64_t truth = 70000000 + i * kPeriod + s * 4000;
      const auto result = tracker.map(s, truth % StampTracker::kKinectWrap_us, i * kPeriod);
      ASSERT_EQ(result.stamp_us, truth) << i;
      wraps[s] += result.step == StampTracker::Step::kWrap;
    }
  }
  EXPECT_EQ(wraps[0], 51);
  EXPECT_EQ(wraps[1], 51);
}

TEST(StampTracker, BothStreamsAgreeAfterAJump) {
  for (const std::int64_t jump : {-900000000LL, -5000000LL, 800000000LL}) {
    StampTracker tracker;
    tracker.reset(kPeriod, true);
    std::int64_t last[2] = {0, 0};
    for (int i = 0; i < 60; ++i) {
      const std::int64_t clock = 1000000000 + i * kPeriod + (i >= 30 ? jump : 0);
      for (int s = 0; s < 2; ++s) {
        const auto result = tracker.map(s, clock + s * 4000, i * kPeriod);
        EXPECT_EQ(result.step, i == 30 ? StampTracker::Step::kJump : StampTracker::Step::kForward) << i;
        EXPECT_GT(result.stamp_us, last[s]);
        EXPECT_LE(result.stamp_us - 1000000000, i * kPeriod + 2 * kPeriod);
        last[s] = result.stamp_us;
      }
      EXPECT_EQ(last[1] - last[0], 4000) << "the offset between the streams survives";
    }
  }
}

TEST(StampTracker, StallIsNotAJump) {
  StampTracker tracker;
  tracker.reset(kPeriod, true);
  tracker.map(0, 1000000, 0);
  const auto result = tracker.map(0, 31000000, 30000000);
  EXPECT_EQ(result.step, StampTracker::Step::kForward);
  EXPECT_EQ(result.stamp_us, 31000000);
}

TEST(StampTracker, RestartContinuesOnTheHostClock) {
  StampTracker tracker;
  tracker.reset(kPeriod, true);
  tracker.map(0, 50000000, 100);
  tracker.map(1, 50004000, 200);
  tracker.restart();
  const auto colour = tracker.map(0, 10, 10000100);
  const auto depth = tracker.map(1, 4010, 10000200);
  EXPECT_EQ(colour.stamp_us, 60000000);
  EXPECT_EQ(depth.stamp_us, 60004000);
  EXPECT_EQ(colour.step, StampTracker::Step::kForward);
}

TEST(StampTracker, StampsIncreaseForAnyInput) {
  Random random(7);
  StampTracker tracker;
  tracker.reset(kPeriod, true);
  std::int64_t last[2] = {-1, -1};
  std::int64_t now = 0;
  for (int i = 0; i < 20000; ++i) {
    const int s = static_cast<int>(random.below(2));
    now += random.below(100000);
    const auto raw =
        static_cast<std::int64_t>(random.below(4) == 0 ? random.next() : static_cast<std::uint32_t>(now));
    const auto result = tracker.map(s, raw, now);
    ASSERT_TRUE(last[s] < 0 || result.stamp_us > last[s]);
    last[s] = result.stamp_us;
  }
}

TEST(StampTracker, RecordingsKeepTheirGaps) {
  StampTracker tracker;
  tracker.reset(kPeriod, false);
  tracker.map(0, 0, 0);
  EXPECT_EQ(tracker.map(0, 500000000, 1).stamp_us, 500000000);
}

}  // namespace
}  // namespace plvo
