// SPDX-License-Identifier: Apache-2.0
// Tests which samples of a frame's surfaces are kept: all of them within the capacity, otherwise as many of a
// small surface as of a large one.
#include "plvo/surfaces/surface_sampling.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "depth_picture.hpp"

namespace plvo {
namespace {

constexpr int kImageWidth = 320;
constexpr int kImageHeight = 240;
constexpr Pinhole kCamera{262, 262, 159.5, 119.5};

struct SamplingRig {
  explicit SamplingRig(int samples) : memory(1 << 20), arena(memory) {
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

// A wall and a strip of floor below it.
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

TEST(SurfaceSampling, KeepsAllSamplesWithinTheCapacity) {
  SamplingRig rig(400);
  rig.sample(wall_and_floor());
  const Share share = share_of(rig.features);
  EXPECT_GT(share.wall, 60);
  EXPECT_GT(share.floor, 5);
  EXPECT_LT(share.floor, 40);
  EXPECT_EQ(share.other, 0) << "a window that holds both is no plane";
}

TEST(SurfaceSampling, KeepsAsManySamplesOfASmallSurfaceAsOfALargeOne) {
  SamplingRig all(400);
  all.sample(wall_and_floor());
  const int floor = share_of(all.features).floor;
  SamplingRig few(2 * floor);
  few.sample(wall_and_floor());
  const Share share = share_of(few.features);
  EXPECT_EQ(share.floor, floor);
  EXPECT_EQ(share.wall, floor);
  // The samples of the wall are spread over it: each quarter of its width has some.
  int quarters[4] = {};
  for (const SurfaceSample& sample : few.features.samples)
    if (sample.normal.z() < -0.99)
      ++quarters[static_cast<int>(project(kCamera, sample.p).x() / (kImageWidth / 4.0))];
  for (const int quarter : quarters) EXPECT_GT(quarter, 0);
}

TEST(SurfaceSampling, KeepsNothingAndNeedsNoMemoryWithoutCapacity) {
  SamplingRig rig(0);
  rig.sample(wall_and_floor());
  EXPECT_TRUE(rig.features.samples.empty());
  Arena sizer = Arena::counting();
  reserve_surface_sampling(sizer, kImageWidth, kImageHeight, 0);
  EXPECT_EQ(sizer.peak(), 0U);
}

TEST(SurfaceSampling, ReplacesTheSamplesOfTheLastFrame) {
  SamplingRig rig(400);
  rig.sample(wall_and_floor());
  rig.sample({kImageWidth, kImageHeight, [](int, int) { return 0.0; }});
  EXPECT_TRUE(rig.features.samples.empty());
}

}  // namespace
}  // namespace plvo
