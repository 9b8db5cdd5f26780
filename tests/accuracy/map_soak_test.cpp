// SPDX-License-Identifier: Apache-2.0
// A camera moves round after round in a simulated room with a map beside it: no allocation, a map that is no
// larger than it may be, and an error in the map that does not grow while that of the odometry does. The
// images of a round are rendered once. docs/results/map.md has 100 000 frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "allocation_guard.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/map/map.hpp"
#include "plvo/odometry/odometry.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

constexpr int kFramesOfARound = 200, kRounds = 15;
constexpr int kFirst = 5;  // rounds with which the last one is compared
constexpr int kKeyframes = 32;
constexpr std::int64_t kFrame_ns = 33'333'333;

struct Round {
  int lost = 0;
  double odometry_m = 0, map_m = 0;  // root mean square
  std::size_t keyframes = 0;
};

TEST(MapSoak, AllocatesNothingAndStaysCorrectRoundAfterRound) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "a sanitizer has its own malloc";
  SimulatorOptions options = test::small_options(SceneName::kDesk);
  options.frames = kFramesOfARound + 1;  // the last pose is the first one again
  options.seed = 3;
  const std::vector<test::Shot> shots = test::shoot(options);
  ASSERT_EQ(shots.size(), static_cast<std::size_t>(options.frames));

  const CameraModel& camera = options.camera;
  Limits limits;
  limits.width = camera.width;
  limits.height = camera.height;
  MapLimits map_limits;
  map_limits.keyframes = kKeyframes;
  std::vector<std::byte> memory(required_bytes(limits));
  std::vector<std::byte> map_memory(Map::required_bytes(map_limits, camera.width, camera.height));
  Odometry odometry;
  Map map;
  ASSERT_TRUE(odometry.init(memory, camera, Config(), limits).ok());
  ASSERT_TRUE(map.init(map_memory, camera, Config(), map_limits).ok());

  RgbdFrame frame;
  frame.stamp_ns = kFrame_ns;
  std::vector<Round> rounds(kRounds);
  AllocationGuard guard;
  for (Round& round : rounds) {
    int posed = 0;
    for (int k = 0; k < kFramesOfARound; ++k) {
      const test::Shot& shot = shots[static_cast<std::size_t>(k)];
      frame.stamp_ns += kFrame_ns;
      frame.depth_stamp_ns = frame.stamp_ns;
      frame.colour = {shot.colour.data(), camera.width, camera.height, std::ptrdiff_t{3} * camera.width,
                      PixelFormat::kRgb8};
      frame.depth = {shot.depth.data(), camera.width, camera.height, camera.width, 0.0002};
      const TrackResult result = odometry.track(frame);
      const MapResult in_map = map.update(odometry, result);
      if (!has_pose(result) || !in_map.located) {
        ++round.lost;
        continue;
      }
      const Vector3 truth = shots[0].T_world_camera.inverse() * shot.T_world_camera.t;
      round.odometry_m += (result.T_world_camera.t - truth).squaredNorm();
      round.map_m += (in_map.T_map_world * result.T_world_camera.t - truth).squaredNorm();
      ++posed;
    }
    round.odometry_m = std::sqrt(round.odometry_m / std::max(posed, 1));
    round.map_m = std::sqrt(round.map_m / std::max(posed, 1));
    round.keyframes = map.graph().size();
  }
  guard.disarm();
  EXPECT_EQ(guard.calls(), 0);
  for (const Round& round : rounds)
    std::printf("%d lost, %zu keyframes, RMS error of the odometry %.1f mm, in the map %.1f mm\n", round.lost,
                round.keyframes, 1e3 * round.odometry_m, 1e3 * round.map_m);
  EXPECT_GT(map.counts().loops, 50);
  EXPECT_GT(map.counts().removed, 0);
  double first_m = 0;
  for (int i = 0; i < kRounds; ++i) {
    const Round& round = rounds[static_cast<std::size_t>(i)];
    EXPECT_LE(round.keyframes, static_cast<std::size_t>(kKeyframes));
    EXPECT_LT(round.lost, kFramesOfARound / 20);
    if (i < kFirst) first_m = std::max(first_m, round.map_m);
  }
  EXPECT_LT(rounds.back().map_m, 1.5 * first_m);
  EXPECT_LT(rounds.back().map_m, 0.5 * rounds.back().odometry_m);
}

}  // namespace
}  // namespace plvo
