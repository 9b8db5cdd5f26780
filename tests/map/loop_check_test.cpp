// SPDX-License-Identifier: Apache-2.0
// A pair of views that are alike takes the most memory: all features match.
#include "plvo/map/loop_check.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

const CameraModel kCamera{320, 240, Pinhole{250, 250, 160, 120}, {}};

// A view that fills these limits: features at random places, with random descriptors.
class FullView {
 public:
  explicit FullView(const MapLimits& limits)
      : descriptors_(static_cast<std::size_t>(limits.keypoints)),
        points_(descriptors_.size()),
        line_descriptors_(static_cast<std::size_t>(limits.segments)),
        lines_(line_descriptors_.size()) {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      for (std::uint64_t& word : descriptors_[i])
        word = static_cast<std::uint64_t>(random_.next()) << 32 | random_.next();
      points_[i] = {within(20, 300), within(20, 220), within(1, 3), 50, 0};
    }
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      for (std::uint8_t& entry : line_descriptors_[i].value)
        entry = static_cast<std::uint8_t>(random_.below(256));
      MapLine& line = lines_[i];
      line.a = {within(-0.8F, 0), within(-0.8F, 0), 2};
      line.b = {line.a[0] + within(0.2F, 0.8F), line.a[1] + within(0.2F, 0.8F), within(1.5F, 2.5F)};
      for (const std::size_t diagonal : {0U, 2U, 5U, 9U}) line.across[diagonal] = 1e-6F;
    }
  }
  MapFeatures features() { return {descriptors_, points_, line_descriptors_, lines_}; }

 private:
  float within(float low, float high) { return low + (high - low) * static_cast<float>(random_.uniform()); }

  Random random_{7};
  std::vector<Descriptor> descriptors_;
  std::vector<MapPoint> points_;
  std::vector<LineDescriptor> line_descriptors_;
  std::vector<MapLine> lines_;
};

TEST(LoopCheck, TheReservedMemorySufficesForTwoFullViewsThatAreEqual) {
  constexpr MapLimits kMost{MapLimits::kLeastKeyframes, MapLimits::kMostKeypoints, MapLimits::kMostSegments};
  for (const MapLimits& limits : {MapLimits(), kMost}) {
    Arena sizer = Arena::counting();
    LoopCheck::reserve(sizer, limits, kCamera.width, kCamera.height);
    std::vector<std::byte> memory(sizer.peak() + kArenaAlignment);
    Arena arena{memory};
    FullView view(limits);
    const LoopMeasurement loop = LoopCheck(kCamera, Config())(view.features(), view.features(), arena);
    std::printf("%d points, %d lines: %zu of %zu bytes, %d inliers\n", limits.keypoints, limits.segments,
                arena.peak(), sizer.peak(), loop.inliers);
    EXPECT_FALSE(arena.exhausted());
    ASSERT_TRUE(loop.found);
    EXPECT_GT(loop.inliers, limits.keypoints);
    EXPECT_LT(loop.T_old_new.t.norm(), 1e-3);
  }
}

// Every point has a twin in the same image, so no descriptor belongs to one place alone. The prediction says
// which of the two is meant.
TEST(LoopCheck, APredictionTellsTwinsApart) {
  MapLimits limits;
  limits.segments = 1;
  FullView view(limits);
  const MapFeatures features = view.features();
  const std::size_t half = features.points.size() / 2;
  for (std::size_t i = 0; i < half; ++i) features.descriptors[half + i] = features.descriptors[i];
  Arena sizer = Arena::counting();
  LoopCheck::reserve(sizer, limits, kCamera.width, kCamera.height);
  std::vector<std::byte> memory(sizer.peak() + kArenaAlignment);
  Arena arena{memory};
  const LoopCheck check(kCamera, Config());
  EXPECT_FALSE(check(features, features, arena).found);
  const Se3 near_by{rotation_exp(Vector3(0.005, -0.005, 0.005)), Vector3(0.01, 0.01, -0.01)};
  const LoopMeasurement loop = check(features, features, arena, &near_by);
  ASSERT_TRUE(loop.found);
  EXPECT_GT(loop.inliers, 150);
  EXPECT_LT(loop.T_old_new.t.norm(), 1e-3);
  const Se3 elsewhere{Matrix3::Identity(), Vector3(0.6, 0, 0)};
  EXPECT_FALSE(check(features, features, arena, &elsewhere).found);
  EXPECT_FALSE(arena.exhausted());
}

}  // namespace
}  // namespace plvo
