// SPDX-License-Identifier: Apache-2.0
// Depth in its own time: every pixel of the depth image must be the distance, from where the camera stood
// when that row of depth was exposed, to the walls of a room whose size is known. The expected depth comes
// from the planes themselves, not from the ray caster.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "plvo/simulator/sensor/kinect_depth.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

using test::small_options;

// The bare room's walls, floor and ceiling.
const Vector3 kRoom_m(6, 5, 2.7);

double depth_of_walls(const CameraModel& camera, const Se3& T_world_camera, int x, int y) {
  const Vector3 ray = T_world_camera.R * back_project(camera.pinhole, x, y, 1.0);
  double nearest = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray(axis) == 0) continue;
    const double wall = ray(axis) > 0 ? kRoom_m(axis) : 0;
    nearest = std::min(nearest, (wall - T_world_camera.t(axis)) / ray(axis));
  }
  return nearest;
}

SimulatorOptions bare_room() {
  SimulatorOptions options = small_options(SceneName::kBare);
  options.noise = false;
  options.frames = 40;  // slow enough for a hand, fast enough that milliseconds show
  return options;
}

struct Shares {
  double own_time = 0;     // of the pixels that are on a wall as seen at depth's own time
  double colour_time = 0;  // … as seen at the colour's
  double nearest_ms = 1e9, farthest_ms = -1e9;  // depth stamp − colour stamp
};

// `exposed_s`: the middle row's moment after the depth stamp; `scale`: reported over true depth.
Shares measure(const SimulatorOptions& options, double exposed_s, double readout_s, double scale = 1) {
  std::unique_ptr<SimulatedCamera> camera;
  const Status status = SimulatedCamera::create(options, camera);
  EXPECT_TRUE(status.ok()) << status.message();
  Shares shares;
  std::size_t pixels = 0;
  RgbdFrame frame;
  while (status.ok() && camera->next(frame).ok()) {
    const double apart_ms = static_cast<double>(frame.depth_stamp_ns - frame.stamp_ns) * 1e-6;
    shares.nearest_ms = std::min(shares.nearest_ms, apart_ms);
    shares.farthest_ms = std::max(shares.farthest_ms, apart_ms);
    const Se3 T_colour = camera->ground_truth(frame.stamp_ns);
    for (int y = 0; y < frame.depth.height; ++y) {
      const double row_s = exposed_s + readout_s * (y / (frame.depth.height - 1.0) - 0.5);
      const Se3 T_depth = camera->ground_truth(frame.depth_stamp_ns + std::llround(row_s * 1e9));
      for (int x = 0; x < frame.depth.width; ++x) {
        const double reported = frame.depth.data[y * frame.depth.stride + x] * frame.depth.metres_per_unit;
        const double own = depth_of_walls(options.camera, T_depth, x, y);
        // Half a unit of the format, and the rays are floats.
        const double tolerance = 0.5 * sim::kMetresPerUnit + 2e-5;
        EXPECT_LE(reported, scale * own + tolerance) << "behind the wall at " << x << ' ' << y;
        shares.own_time += std::abs(reported - scale * own) <= tolerance ? 1 : 0;
        const double then = depth_of_walls(options.camera, T_colour, x, y);
        shares.colour_time += std::abs(reported - scale * then) <= tolerance ? 1 : 0;
        ++pixels;
      }
    }
  }
  shares.own_time /= static_cast<double>(pixels);
  shares.colour_time /= static_cast<double>(pixels);
  return shares;
}

constexpr double kWallShare = 0.38;  // the rest is bricks, posters, the door, the window, the beam …
constexpr double kByChance = 0.25;

TEST(DepthSchedule, ByDefaultDepthIsTakenWithColour) {
  const Shares shares = measure(bare_room(), 0, 0);
  EXPECT_GT(shares.own_time, kWallShare);
  EXPECT_EQ(shares.own_time, shares.colour_time);
  EXPECT_EQ(shares.nearest_ms, 0);
  EXPECT_EQ(shares.farthest_ms, 0);
}

TEST(DepthSchedule, DelayMovesTheExposureNotTheStamp) {
  for (const double delay_s : {-0.015, 0.02}) {
    SimulatorOptions options = bare_room();
    options.depth_schedule.delay_s = delay_s;
    const Shares shares = measure(options, delay_s, 0);
    EXPECT_GT(shares.own_time, kWallShare) << delay_s;
    EXPECT_LT(shares.colour_time, kByChance) << delay_s;
    EXPECT_EQ(shares.farthest_ms, 0) << delay_s;
  }
}

TEST(DepthSchedule, ReadoutRollsAboutTheMiddleRow) {
  SimulatorOptions options = bare_room();
  options.depth_schedule.readout_s = 0.03;
  const Shares shares = measure(options, 0, 0.03);
  EXPECT_GT(shares.own_time, kWallShare);
  EXPECT_LT(shares.colour_time, 0.5 * shares.own_time);
}

TEST(DepthSchedule, DepthRollsWithColourUnlessTold) {
  SimulatorOptions options = bare_room();
  options.camera.readout_s = 0.026;
  EXPECT_GT(measure(options, 0, 0.026).own_time, kWallShare);
  options.depth_schedule.readout_s = 0;
  EXPECT_GT(measure(options, 0, 0).own_time, kWallShare);
}

TEST(DepthSchedule, StampOffsetIsSeenInTheStampAndInThePicture) {
  SimulatorOptions options = bare_room();
  options.depth_schedule.stamp_offset_s = 0.012;
  options.depth_schedule.delay_s = -0.005;
  options.depth_schedule.readout_s = 0.02;
  const Shares shares = measure(options, -0.005, 0.02);
  EXPECT_GT(shares.own_time, kWallShare);
  EXPECT_LT(shares.colour_time, kByChance);
  EXPECT_EQ(shares.nearest_ms, 12);
  EXPECT_EQ(shares.farthest_ms, 12);
}

TEST(DepthSchedule, AClockOfItsOwnSweepsThroughHalfAFrameToEachSide) {
  SimulatorOptions options = bare_room();
  options.depth_schedule.fps = 31;
  const Shares shares = measure(options, 0, 0);
  EXPECT_GT(shares.own_time, kWallShare);
  const double half_frame_ms = 500 / 31.0;
  EXPECT_LT(shares.nearest_ms, -0.9 * half_frame_ms);
  EXPECT_GT(shares.farthest_ms, 0.9 * half_frame_ms);
  EXPECT_GE(shares.nearest_ms, -half_frame_ms - 1e-3);
  EXPECT_LE(shares.farthest_ms, half_frame_ms + 1e-3);

  std::unique_ptr<SimulatedCamera> camera;
  ASSERT_TRUE(SimulatedCamera::create(options, camera).ok());
  for (int k = 1; k < options.frames; ++k)
    EXPECT_GT(camera->depth_stamp_ns(k), camera->depth_stamp_ns(k - 1)) << "each depth image is used once";
}

TEST(DepthSchedule, JitterMovesTheStampsAlone) {
  SimulatorOptions options = bare_room();
  options.frames = 400;
  options.depth_schedule.stamp_offset_s = 0.004;
  std::unique_ptr<SimulatedCamera> steady, jittery;
  ASSERT_TRUE(SimulatedCamera::create(options, steady).ok());
  options.depth_schedule.stamp_jitter_s = 0.002;
  ASSERT_TRUE(SimulatedCamera::create(options, jittery).ok());
  double squares = 0;
  double sum = 0;
  for (int k = 0; k < options.frames; ++k) {
    const double error_s = static_cast<double>(jittery->depth_stamp_ns(k) - steady->depth_stamp_ns(k)) * 1e-9;
    sum += error_s;
    squares += error_s * error_s;
    if (k > 0) {
      EXPECT_GT(jittery->depth_stamp_ns(k), jittery->depth_stamp_ns(k - 1));
    }
  }
  EXPECT_NEAR(sum / options.frames, 0, 3 * 0.002 / std::sqrt(options.frames));
  EXPECT_NEAR(std::sqrt(squares / options.frames), 0.002, 0.0003);
  RgbdFrame a, b;
  ASSERT_TRUE(steady->next(a).ok());
  ASSERT_TRUE(jittery->next(b).ok());
  EXPECT_TRUE(std::equal(a.depth.data, a.depth.data + 160 * 120, b.depth.data));
}

TEST(DepthSchedule, ScaleErrorStretchesWhatIsReported) {
  SimulatorOptions options = bare_room();
  options.frames = 6;
  options.depth.scale_error = 1.01;
  EXPECT_GT(measure(options, 0, 0, 1.01).own_time, kWallShare);

  // With the sensor's noise, the same picture times the error.
  options.noise = true;
  const std::vector<test::Shot> wrong = test::shoot(options);
  options.depth.scale_error = 1;
  const std::vector<test::Shot> right = test::shoot(options);
  std::size_t measured = 0;
  for (std::size_t i = 0; i < right[0].depth.size(); ++i) {
    EXPECT_NEAR(wrong[0].depth[i], 1.01 * right[0].depth[i], 1.01);
    measured += right[0].depth[i] > 0 ? 1 : 0;
  }
  EXPECT_GT(measured, right[0].depth.size() / 2);
}

TEST(DepthSchedule, ColourDoesNotDependOnIt) {
  SimulatorOptions options = small_options(SceneName::kDesk);
  options.frames = 2;
  const std::vector<test::Shot> together = test::shoot(options);
  options.depth_schedule.delay_s = 0.02;
  options.depth_schedule.readout_s = 0.03;
  const std::vector<test::Shot> apart = test::shoot(options);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(together[k].colour, apart[k].colour);
    EXPECT_EQ(together[k].exact, apart[k].exact);
    EXPECT_NE(together[k].depth, apart[k].depth);
  }
}

TEST(DepthSchedule, RefusesInvalidOptions) {
  const auto refused = [](auto change) {
    SimulatorOptions options = bare_room();
    change(options);
    return options.validate().code() == StatusCode::kInvalidArgument;
  };
  EXPECT_FALSE(refused([](SimulatorOptions&) {}));
  EXPECT_TRUE(refused([](SimulatorOptions& o) { o.depth_schedule.delay_s = 0.2; }));
  EXPECT_TRUE(refused([](SimulatorOptions& o) { o.depth_schedule.delay_s = std::nan(""); }));
  EXPECT_TRUE(refused([](SimulatorOptions& o) { o.depth_schedule.readout_s = -0.01; }));
  EXPECT_TRUE(refused([](SimulatorOptions& o) { o.depth_schedule.stamp_offset_s = 0.02; }));
  EXPECT_TRUE(refused([](SimulatorOptions& o) { o.depth_schedule.fps = 29; }));
  EXPECT_TRUE(refused([](SimulatorOptions& o) { o.depth_schedule.stamp_jitter_s = 0.004; }));
  EXPECT_TRUE(refused([](SimulatorOptions& o) { o.depth.scale_error = 0; }));
}

}  // namespace
}  // namespace plvo
