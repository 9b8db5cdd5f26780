// SPDX-License-Identifier: Apache-2.0
// A camera that takes few pictures a second: where a wall repeats itself, or an image hardly shows anything,
// a wrong motion explains some of what was matched, and the prediction is too far off to tell. A frame may be
// lost; none may stand a brick beside itself.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <vector>

#include "plvo/odometry/odometry.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

// Half of what a brick is high, and more than any right motion errs.
constexpr double kOff_m = 0.035;

void expect_no_motion_off(const SimulatorOptions& options) {
  std::unique_ptr<SimulatedCamera> camera;
  const Status created = SimulatedCamera::create(options, camera);
  ASSERT_TRUE(created.ok()) << created.message();
  const Limits limits;
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  const Status ready = odometry.init(memory, camera->model(), Config{}, limits);
  ASSERT_TRUE(ready.ok()) << ready.message();

  int tracked = 0;
  double most = 0;
  RgbdFrame frame;
  while (camera->next(frame).ok()) {
    const TrackResult result = odometry.track(frame);
    if (result.state != TrackState::kTracking) continue;
    const Se3 truth =
        camera->ground_truth(frame.stamp_ns).inverse() * camera->ground_truth(result.reference_stamp_ns);
    const double error = boxminus(result.T_camera_reference, truth).head<3>().norm();
    EXPECT_LT(error, kOff_m) << "at " << frame.stamp_ns << ", with " << result.points.inliers
                             << " points and " << result.lines.inliers << " lines";
    most = std::max(most, error);
    ++tracked;
  }
  std::printf("%d of %d frames tracked, at most %.1f mm off\n", tracked, options.frames, 1e3 * most);
  EXPECT_GT(tracked, 0.85 * options.frames);
}

// 18 cm and 9° from one frame to the next, before bricks.
TEST(LongSteps, ABrickOffDoesNotConvince) {
  SimulatorOptions options;
  options.scene = SceneName::kBare;
  options.fps = 3;
  options.frames = 38;
  expect_no_motion_off(options);
}

TEST(LongSteps, NeitherDoesOneInAHall) {
  SimulatorOptions options;
  options.scene = SceneName::kHall;
  options.fps = 4;
  options.frames = 24;
  expect_no_motion_off(options);
}

}  // namespace
}  // namespace plvo
