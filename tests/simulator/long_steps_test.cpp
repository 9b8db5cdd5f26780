// SPDX-License-Identifier: Apache-2.0
// A camera that takes few pictures a second: where a wall repeats itself, or an image hardly shows anything,
// a wrong motion explains some of what was matched, and the prediction is too far off to tell. A frame may be
// lost; none may stand a brick beside itself.
#include <algorithm>
#include <cstddef>
#include <cstdio>

#include "tracked_walk.hpp"

namespace plvo {
namespace {

// Half of what a brick is high, and more than any right motion errs.
constexpr double kOff_m = 0.035;

void expect_no_motion_off(SceneName scene, double fps, int frames) {
  SimulatorOptions options;
  options.scene = scene;
  options.fps = fps;
  options.frames = frames;
  const test::TrackedWalk walk = test::track_walk(options, Limits{}, Config{});
  int tracked = 0;
  double most = 0;
  for (std::size_t i = 0; i < walk.results.size(); ++i) {
    const TrackResult& result = walk.results[i];
    if (result.state != TrackState::kTracking) continue;
    const double error = walk.error_of_motion(i).head<3>().norm();
    EXPECT_LT(error, kOff_m) << "at " << result.stamp_ns << ", with " << result.points.inliers
                             << " points and " << result.lines.inliers << " lines";
    most = std::max(most, error);
    ++tracked;
  }
  std::printf("%d of %d frames tracked, at most %.1f mm off\n", tracked, frames, 1e3 * most);
  EXPECT_GT(tracked, 0.85 * frames);
}

// 18 cm and 9° from one frame to the next, before bricks.
TEST(LongSteps, ABrickOffDoesNotConvince) { expect_no_motion_off(SceneName::kBare, 3, 38); }
TEST(LongSteps, NeitherDoesOneInAHall) { expect_no_motion_off(SceneName::kHall, 4, 24); }

}  // namespace
}  // namespace plvo
