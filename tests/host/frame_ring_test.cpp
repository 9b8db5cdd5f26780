// SPDX-License-Identifier: Apache-2.0
// The ring between capture and odometry: what is dropped, in which order frames come, that nothing tears, and
// that nothing is allocated once it stands.
#include "plvo/host/frame_ring.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "allocation_guard.hpp"

namespace plvo {
namespace {

constexpr int kWidth = 8;
constexpr int kHeight = 6;
constexpr int kPatience_ms = 120'000;  // so that what hangs fails by name; nothing is judged by it

// Every pixel of frame n says n.
struct Picture {
  std::vector<std::uint8_t> colour =
      std::vector<std::uint8_t>((kWidth * 3 + 5) * kHeight);  // a stride that is wider
  std::vector<std::uint16_t> depth = std::vector<std::uint16_t>((kWidth + 2) * kHeight);
  RgbdFrame frame(int n) {
    std::fill(colour.begin(), colour.end(), static_cast<std::uint8_t>(n));
    std::fill(depth.begin(), depth.end(), static_cast<std::uint16_t>(n));
    RgbdFrame f;
    f.stamp_ns = n;
    f.depth_stamp_ns = n;
    f.colour = {colour.data(), kWidth, kHeight, kWidth * 3 + 5, PixelFormat::kRgb8};
    f.depth = {depth.data(), kWidth, kHeight, kWidth + 2, 0.001};
    return f;
  }
};

void expect_whole(const RgbdFrame& frame) {
  const auto n = static_cast<int>(frame.stamp_ns);
  ASSERT_EQ(frame.colour.width, kWidth);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      ASSERT_EQ(frame.colour.data[y * frame.colour.stride_bytes + x * 3 + 2], static_cast<std::uint8_t>(n));
      ASSERT_EQ(frame.depth.data[y * frame.depth.stride + x], static_cast<std::uint16_t>(n));
    }
  }
}

TEST(FrameRing, NewestWinsAndDropsAreCounted) {
  FrameRing ring(kWidth, kHeight, 3, RingPolicy::kNewest);
  Picture picture;
  for (int n = 1; n <= 5; ++n) ASSERT_TRUE(ring.push(picture.frame(n), 100 + n));
  RgbdFrame frame;
  std::int64_t arrival = 0;
  ASSERT_EQ(ring.take(frame, arrival, 0), FrameRing::Take::kFrame);
  EXPECT_EQ(frame.stamp_ns, 5);
  EXPECT_EQ(arrival, 105);
  expect_whole(frame);
  EXPECT_EQ(ring.counters().dropped, 4u);
  EXPECT_EQ(ring.counters().pushed, 5u);
  EXPECT_EQ(ring.counters().taken, 1u);
  EXPECT_EQ(ring.take(frame, arrival, 1), FrameRing::Take::kTimeout);
}

TEST(FrameRing, ReadersFrameSurvivesAnyNumberOfPushes) {
  for (RingPolicy policy : {RingPolicy::kNewest, RingPolicy::kInOrder}) {
    FrameRing ring(kWidth, kHeight, 3, policy);
    Picture picture;
    ring.push(picture.frame(1), 0);
    RgbdFrame held;
    std::int64_t arrival = 0;
    ASSERT_EQ(ring.take(held, arrival, 0), FrameRing::Take::kFrame);
    for (int n = 2; n < 20; ++n) ring.push(picture.frame(n), 0);
    EXPECT_EQ(held.stamp_ns, 1);
    expect_whole(held);
  }
}

TEST(FrameRing, InOrderDropsTheOldest) {
  FrameRing ring(kWidth, kHeight, 4, RingPolicy::kInOrder);
  Picture picture;
  for (int n = 1; n <= 6; ++n) ring.push(picture.frame(n), 0);
  ring.close();
  RgbdFrame frame;
  std::int64_t arrival = 0;
  for (int n = 3; n <= 6; ++n) {
    ASSERT_EQ(ring.take(frame, arrival, 0), FrameRing::Take::kFrame);
    EXPECT_EQ(frame.stamp_ns, n);
    expect_whole(frame);
  }
  EXPECT_EQ(ring.take(frame, arrival, 0), FrameRing::Take::kClosed);
  EXPECT_EQ(ring.counters().dropped, 2u);
  EXPECT_FALSE(ring.push(picture.frame(7), 0));
}

TEST(FrameRing, EveryFrameArrivesInOrderWhenTheProducerWaits) {
  FrameRing ring(kWidth, kHeight, 3, RingPolicy::kEvery);
  constexpr int kFrames = 400;
  std::thread producer([&ring] {
    Picture picture;
    for (int n = 1; n <= kFrames; ++n) ring.push(picture.frame(n), 0);
    ring.close();
  });
  RgbdFrame frame;
  std::int64_t arrival = 0;
  int expected = 1;
  while (ring.take(frame, arrival, kPatience_ms) == FrameRing::Take::kFrame) {
    EXPECT_EQ(frame.stamp_ns, expected++);
    expect_whole(frame);
  }
  producer.join();
  EXPECT_EQ(expected, kFrames + 1);
  EXPECT_EQ(ring.counters().dropped, 0u);
}

TEST(FrameRing, ClosingFreesAWaitingProducer) {
  FrameRing ring(kWidth, kHeight, 3, RingPolicy::kEvery);
  std::atomic<bool> last_push{true};
  std::thread producer([&] {
    Picture picture;
    for (int n = 1; n <= 3; ++n) ring.push(picture.frame(n), 0);
    last_push = ring.push(picture.frame(4), 0);
  });
  while (ring.counters().pushed < 3) std::this_thread::yield();
  ring.close();
  producer.join();
  EXPECT_FALSE(last_push);
}

TEST(FrameRing, NothingTearsAndNothingAllocatesUnderAFastProducer) {
  FrameRing ring(kWidth, kHeight, 3, RingPolicy::kNewest);
  Picture picture;
  std::atomic<bool> go{false};
  std::int64_t allocations_of_producer = -1;
  std::thread producer([&] {
    while (!go) std::this_thread::yield();
    const AllocationGuard guard;  // each thread's own; under a sanitizer the counts stay zero
    for (int n = 1; n <= 20'000; ++n) ring.push(picture.frame(n), n);
    ring.close();
    allocations_of_producer = guard.calls();
  });
  RgbdFrame frame;
  std::int64_t arrival = 0;
  std::int64_t last = 0;
  AllocationGuard guard;
  go = true;
  for (;;) {
    const FrameRing::Take got = ring.take(frame, arrival, kPatience_ms);
    if (got != FrameRing::Take::kFrame) break;
    ASSERT_GT(frame.stamp_ns, last);
    last = frame.stamp_ns;
    expect_whole(frame);
  }
  guard.disarm();
  producer.join();
  EXPECT_EQ(last, 20'000);
  EXPECT_EQ(guard.calls(), 0);
  EXPECT_EQ(allocations_of_producer, 0);
  const FrameRing::Counters counters = ring.counters();
  EXPECT_EQ(counters.taken + counters.dropped, counters.pushed);
}

TEST(FrameRing, FramesTooLargeAreRefusedAndGrayTakesOneByte) {
  FrameRing ring(kWidth, kHeight - 1, 3, RingPolicy::kNewest);
  Picture picture;
  EXPECT_FALSE(ring.push(picture.frame(1), 0));
  EXPECT_EQ(ring.counters().refused, 1u);

  FrameRing gray_ring(kWidth, kHeight, 3, RingPolicy::kNewest);
  RgbdFrame gray = picture.frame(9);
  gray.colour.format = PixelFormat::kGray8;
  gray.depth = {};
  ASSERT_TRUE(gray_ring.push(gray, 0));
  RgbdFrame frame;
  std::int64_t arrival = 0;
  ASSERT_EQ(gray_ring.take(frame, arrival, 0), FrameRing::Take::kFrame);
  EXPECT_EQ(frame.colour.stride_bytes, kWidth);
  EXPECT_EQ(frame.depth.data, nullptr);
}

}  // namespace
}  // namespace plvo
