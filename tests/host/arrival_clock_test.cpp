// SPDX-License-Identifier: Apache-2.0
// The clock of a camera, told by when its frames arrive: late ones do not count, drift and jumps are
// followed.
#include "plvo/host/arrival_clock.hpp"

#include <gtest/gtest.h>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPeriod = 33 * kMs, kDelay = 40 * kMs;
constexpr std::int64_t kCameraAhead = 7'000'000'000'000;  // of the computer's clock

TEST(ArrivalClock, KnowsNothingBeforeTheFirstFrame) {
  ArrivalClock clock(kDelay);
  EXPECT_FALSE(clock.stamp_of(1).has_value());
  clock.frame_arrived(-5, 100);
  EXPECT_EQ(clock.stamp_of(100), -5 + kDelay) << "what is true now, not when the frame was taken";
}

TEST(ArrivalClock, FramesThatAreHeldUpDoNotCount) {
  ArrivalClock clock(kDelay);
  Random random(3);
  std::int64_t host = 0;
  for (int i = 0; i < 600; ++i) {
    host = i * kPeriod;
    const auto late = i % 7 == 3 ? 0 : static_cast<std::int64_t>(random.uniform() * 200e6);
    clock.frame_arrived(host + kCameraAhead, host + kDelay + late);
    if (i < 10) continue;
    ASSERT_EQ(clock.stamp_of(host), host + kCameraAhead) << i;
  }
}

TEST(ArrivalClock, FollowsClocksThatDriftApart) {
  ArrivalClock clock(kDelay);
  // The camera's is slow by 100 parts in a million: 60 ms in ten minutes.
  const auto camera = [](std::int64_t host) { return host - host / 10'000; };
  for (std::int64_t host = 0; host < 600'000 * kMs; host += kPeriod) {
    clock.frame_arrived(camera(host), host + kDelay);
    ASSERT_NEAR(static_cast<double>(*clock.stamp_of(host) - camera(host)), 0, 2.1e6) << host;
  }
}

TEST(ArrivalClock, FollowsAJumpWithinTwoWindows) {
  ArrivalClock clock(kDelay);
  std::int64_t host = 0;
  const auto run = [&](std::int64_t ahead, std::int64_t ns) {
    for (const std::int64_t end = host + ns; host < end; host += kPeriod)
      clock.frame_arrived(host + ahead, host + kDelay);
  };
  run(5000 * kMs, 3000 * kMs);
  run(5080 * kMs, kPeriod);  // forwards: at once
  EXPECT_EQ(clock.stamp_of(host), host + 5080 * kMs);
  run(5000 * kMs, 2 * ArrivalClock::kWindow_ns + kPeriod);
  EXPECT_EQ(clock.stamp_of(host), host + 5000 * kMs);
}

}  // namespace
}  // namespace plvo
