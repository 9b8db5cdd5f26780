// SPDX-License-Identifier: Apache-2.0
// Which samples of a frame's surfaces are kept: all while there is room, then as many of a small surface as
// of a large one.
#include "plvo/surfaces/surface_sampling.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "depth_picture.hpp"

namespace plvo {
namespace {

constexpr int kImageWidth = 320;
constexpr int kImageHeight = 240;
constexpr Pinhole kCamera{262, 262, 159.5, 119.5};

struct Room {
  explicit Room(int samples) : memory(1 << 20), arena(memory) {
    features.allocate(arena, samples);
    arena.seal();
  }
  void sample(const test::DepthPicture& picture) {
    sample_surfaces(picture.sampler(), kCamera, kImageWidth, kImageHeight, 1, arena, features);
  }
  std::vector<std::byte> memory;
  Arena arena;
  SurfaceFeatures features;
};

// A wall, and below it a strip of floor.
test::DepthPicture wall_and_floor() {
  return {kImageWidth, kImageHeight, [](int x, int y) {
            const double floor = test::depth_of_plane(kCamera, x, y, {0, 1, 0}, 0.8);
            return floor > 0 && floor < 2.4 ? floor : 2.4;
          }};
}

struct Share {
  int wall = 0, floor = 0, other = 0;
};
Share share_of(const SurfaceFeatures& features) {
  Share share;
  for (const SurfaceSample& sample : features.samples) {
    if (sample.normal.dot(Vector3(0, 0, -1)) > 0.99)
      ++share.wall;
    else if (sample.normal.dot(Vector3(0, -1, 0)) > 0.99)
      ++share.floor;
    else
      ++share.other;
  }
  return share;
}

TEST(SurfaceSampling, TakesAllThatThereIsRoomFor) {
  Room room(400);
  room.sample(wall_and_floor());
  const Share share = share_of(room.features);
  EXPECT_GT(share.wall, 60);
  EXPECT_GT(share.floor, 5);
  EXPECT_LT(share.floor, 40);
  EXPECT_EQ(share.other, 0) << "a window that holds both is no plane";
}

TEST(SurfaceSampling, ASmallSurfaceIsNotOutvoted) {
  Room all(400);
  all.sample(wall_and_floor());
  const int floor = share_of(all.features).floor;
  Room few(2 * floor);
  few.sample(wall_and_floor());
  const Share share = share_of(few.features);
  EXPECT_EQ(share.floor, floor);
  EXPECT_EQ(share.wall, floor);
  // Those of the wall are spread over it: in each quarter of its width some.
  int quarters[4] = {};
  for (const SurfaceSample& sample : few.features.samples)
    if (sample.normal.z() < -0.99)
      ++quarters[static_cast<int>(project(kCamera, sample.p).x() / (kImageWidth / 4.0))];
  for (const int quarter : quarters) EXPECT_GT(quarter, 0);
}

TEST(SurfaceSampling, WithoutRoomThereAreNone) {
  Room room(0);
  room.sample(wall_and_floor());
  EXPECT_TRUE(room.features.samples.empty());
  Arena sizer = Arena::counting();
  reserve_surface_sampling(sizer, kImageWidth, kImageHeight, 0);
  EXPECT_EQ(sizer.peak(), 0U);
}

TEST(SurfaceSampling, WhatThereWasBeforeIsForgotten) {
  Room room(400);
  room.sample(wall_and_floor());
  room.sample({kImageWidth, kImageHeight, [](int, int) { return 0.0; }});
  EXPECT_TRUE(room.features.samples.empty());
}

}  // namespace
}  // namespace plvo
