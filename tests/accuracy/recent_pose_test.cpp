// SPDX-License-Identifier: Apache-2.0
// A hall seen through a rolling shutter: little has depth, so a recent frame's pose is known to a millimetre
// or worse, of which its matches tell more. Where it was thought to be they are outliers; the motion is found
// all the same, with the pose, and nothing has to be searched for.
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
  const test::TrackedSequence walk = test::track_sequence(options, Limits{}, Config{});
  double most = 0;
  for (std::size_t i = 1; i < walk.results.size(); ++i) {
    const TrackResult& result = walk.results[i];
    ASSERT_EQ(result.state, TrackState::kTracking);
    EXPECT_EQ(result.ransac_iterations, 0) << "in frame " << i;
    most = std::max(most, walk.error_of_motion(i).head<3>().norm());
  }
  std::printf("at most %.1f mm off\n", 1e3 * most);
  EXPECT_LT(most, 0.012);
}

}  // namespace
}  // namespace plvo
