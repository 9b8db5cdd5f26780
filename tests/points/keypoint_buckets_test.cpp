// SPDX-License-Identifier: Apache-2.0
// Compares the search by buckets with a look at every keypoint.
#include "plvo/points/keypoint_buckets.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

TEST(KeypointBuckets, EveryKeypointNearAPositionIsVisitedOnce) {
  constexpr int kColumns_px = 333;
  constexpr int kRows_px = 250;
  Arena sizer = Arena::counting();
  KeypointBuckets::reserve(sizer, 300, kColumns_px, kRows_px);
  std::vector<std::byte> memory(sizer.peak() + kArenaAlignment);
  Arena scratch(memory);

  Random random(3);
  const auto anywhere = [&](int length) {
    return static_cast<double>(random.below(static_cast<std::uint32_t>(16 * length))) / 16;
  };
  std::vector<Keypoint> storage(300);
  FixedVector<Keypoint> keypoints(storage);
  for (int i = 0; i < 300; ++i) {
    Keypoint keypoint;
    keypoint.u = static_cast<float>(anywhere(kColumns_px));
    keypoint.v = static_cast<float>(anywhere(kRows_px));
    ASSERT_TRUE(keypoints.push_back(keypoint));
  }
  const KeypointBuckets buckets(keypoints, kColumns_px, kRows_px, scratch);
  ASSERT_FALSE(scratch.exhausted());

  int near = 0;
  for (int trial = 0; trial < 500; ++trial) {
    // Half of the positions are outside of the image or at its border.
    const double u = anywhere(2 * kColumns_px) - kColumns_px / 2.0;
    const double v = anywhere(2 * kRows_px) - kRows_px / 2.0;
    const double radius = 1 + random.below(60);
    std::set<std::uint16_t> visited;
    buckets.for_each_near(u, v, radius, [&](std::uint16_t i) {
      EXPECT_LT(i, keypoints.size());
      EXPECT_TRUE(visited.insert(i).second) << "visited twice";
    });
    for (std::uint16_t i = 0; i < keypoints.size(); ++i) {
      const double du = static_cast<double>(keypoints[i].u) - u;
      const double dv = static_cast<double>(keypoints[i].v) - v;
      if (du * du + dv * dv > radius * radius) continue;
      ++near;
      EXPECT_TRUE(visited.count(i) == 1) << "trial " << trial << ", keypoint " << i;
    }
  }
  EXPECT_GT(near, 1000);
}

TEST(KeypointBuckets, NothingIsVisitedWithoutScratch) {
  std::vector<Keypoint> storage(1);
  FixedVector<Keypoint> keypoints(storage);
  ASSERT_TRUE(keypoints.push_back(Keypoint()));
  for (const std::size_t bytes : {0U, 1U, 64U}) {
    std::vector<std::byte> memory(bytes + kArenaAlignment);
    Arena scratch(std::span<std::byte>(memory).first(bytes));
    const KeypointBuckets buckets(keypoints, 333, 250, scratch);
    buckets.for_each_near(0, 0, 1000, [](std::uint16_t) { ADD_FAILURE() << "visited"; });
  }
}

}  // namespace
}  // namespace plvo
