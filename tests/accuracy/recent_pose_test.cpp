// SPDX-License-Identifier: Apache-2.0
// A hall seen through a rolling shutter: little has depth, so a recent frame's pose is known to a millimetre
// or worse, and its matches tell more of it. At the pose that was known they are outliers. The motion is
// found with the pose, without a search by RANSAC, except where a motion that differs from the prediction is
// compared with it.
#include <algorithm>
#include <cstddef>
#include <cstdio>

#include "tracked_sequence.hpp"

namespace plvo {
namespace {

TEST(RecentPose, IsEstimatedWithTheMotionInAHall) {
  SimulatorOptions options;
  options.scene = SceneName::kHall;
  options.camera.readout_s = 0.0261;
  options.frames = 25;
  const test::TrackedSequence tracked = test::track_sequence(options, Limits{}, Config{});
  double most = 0;
  int searched = 0;
  for (std::size_t i = 1; i < tracked.results.size(); ++i) {
    const TrackResult& result = tracked.results[i];
    ASSERT_EQ(result.state, TrackState::kTracking);
    searched += result.ransac_iterations > 0 ? 1 : 0;
    most = std::max(most, tracked.error_of_motion(i).head<3>().norm());
  }
  std::printf("at most %.1f mm off; RANSAC in %d of 24 frames\n", 1e3 * most, searched);
  EXPECT_LE(searched, 4);
  EXPECT_LT(most, 0.012);
}

}  // namespace
}  // namespace plvo
