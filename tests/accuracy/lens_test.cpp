// SPDX-License-Identifier: Apache-2.0
// Rational and equidistant cameras from the rays to the pose: the simulator draws through the lens, the
// odometry takes it out again.
#include <algorithm>
#include <cmath>

#include "plvo/odometry/odometry.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

using test::shoot;
using test::Shot;
using test::small_options;

SimulatorOptions through(double focal_px, const Distortion& lens) {
  SimulatorOptions options = small_options(SceneName::kHall);
  options.camera = {320, 240, {focal_px, focal_px, 159.5, 119.5}, lens};
  options.frames = 16;
  return options;
}
const Distortion kRational{0.6, 0.05, 0.001, -0.002, 0, 0.9, 0.12, 0};
const Distortion kFisheye{
    .k1 = -0.0063, .k2 = 0.0493, .k3 = -0.0463, .k4 = 0.0090, .model = LensModel::kEquidistant};

// A pixel's ray hits the same wall as the ray of the pixel that a camera without a lens has there.
TEST(SimulatedLens, DrawsWhereTheLensImages) {
  for (const Distortion& lens : {kRational, kFisheye}) {
    SimulatorOptions options = through(140, lens);
    options.noise = false;
    options.frames = 1;
    const Shot bent = shoot(options)[0];
    options.camera.distortion = {};
    const Shot straight = shoot(options)[0];
    int compared = 0, same = 0, moved = 0;
    for (int v = 4; v < 236; v += 3) {
      for (int u = 4; u < 316; u += 3) {
        const Vector2 raw = distort_pixel({320, 240, options.camera.pinhole, lens}, Vector2(u, v));
        const auto at = [](double x, double y) {
          return static_cast<std::size_t>(std::lround(y)) * 320 + static_cast<std::size_t>(std::lround(x));
        };
        const float there = bent.exact[at(raw.x(), raw.y())], here = straight.exact[at(u, v)];
        ++compared;
        same += std::abs(there - here) < 0.02F * here ? 1 : 0;
        moved += (raw - Vector2(u, v)).norm() > 5 ? 1 : 0;
      }
    }
    EXPECT_GT(same, compared * 95 / 100) << "but for edges, which are half a pixel off";
    EXPECT_GT(moved, compared / 3) << "the lens must matter for the test to mean something";
  }
}

struct Outcome {
  int tracked = 0;
  double error_m = 0, error_rad = 0;  // the largest of a pose
};
Outcome track(const SimulatorOptions& options, const CameraModel& believed) {
  std::unique_ptr<SimulatedCamera> camera;
  EXPECT_TRUE(SimulatedCamera::create(options, camera).ok());
  const Limits limits{.width = 320, .height = 240};
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  const Status status = odometry.init(memory, believed, {}, limits);
  EXPECT_TRUE(status.ok()) << status.message();
  Outcome outcome;
  RgbdFrame frame;
  while (camera->next(frame).ok()) {
    const TrackResult result = odometry.track(frame);
    outcome.tracked += result.state == TrackState::kTracking ? 1 : 0;
    const Se3 truth = camera->pose(0).inverse() * camera->ground_truth(frame.stamp_ns);
    const Vector6 error = boxminus(result.T_world_camera, truth);
    outcome.error_m = std::max(outcome.error_m, error.head<3>().norm());
    outcome.error_rad = std::max(outcome.error_rad, error.tail<3>().norm());
  }
  return outcome;
}

TEST(SimulatedLens, TheOdometryTakesItOut) {
  for (const Distortion& lens : {kRational, kFisheye}) {
    const SimulatorOptions options = through(140, lens);
    const Outcome right = track(options, options.camera);
    EXPECT_EQ(right.tracked, options.frames - 1);
    EXPECT_LT(right.error_m, 0.006);
    EXPECT_LT(right.error_rad, 0.002);
    CameraModel wrong = options.camera;
    wrong.distortion = {};
    const Outcome without = track(options, wrong);
    EXPECT_GT(without.error_m, 4 * right.error_m) << "the lens must matter for the test to mean something";
    EXPECT_GT(without.error_rad, 4 * right.error_rad);
  }
}

}  // namespace
}  // namespace plvo
