// SPDX-License-Identifier: Apache-2.0
// The map in the procedural room: places that come back, places that only look alike, a full map, memory and
// determinism.
#include "plvo/map/map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "fingerprint.hpp"
#include "mapped_camera.hpp"

namespace plvo {
namespace {

using test::kDark;
using test::kFar;
using test::kHeight;
using test::kTurn;
using test::kWidth;
using test::MappedCamera;

void say(const char* what, const MappedCamera& camera) {
  const Map::Counts& counts = camera.map.counts();
  std::printf(
      "%s: %zu keyframes (%d removed), %d pairs compared, %d accepted, %d loops, recognised %d times; "
      "RMS error %.1f mm, in the map %.1f mm\n",
      what, camera.map.graph().size(), counts.removed, counts.compared, counts.accepted, counts.loops,
      camera.recognised, 1e3 * camera.odometry_error_m(), 1e3 * camera.map_error_m());
}

TEST(Map, CorrectsTheDriftWhereAPlaceComesBack) {
  MappedCamera camera(64);
  for (int round = 0; round < 3; ++round) {
    camera.move(0, kFar);
    camera.move(kFar, 0);
  }
  camera.settle(0);
  say("there and back", camera);
  EXPECT_GT(camera.recognised, 3);
  EXPECT_EQ(camera.wrong_loops(), 0);
  EXPECT_LT(camera.map_error_m(), 0.7 * camera.odometry_error_m());
  EXPECT_EQ(camera.allocations, 0);  // always so under a sanitizer
}

TEST(Map, FindsTheCameraThatWasCarriedBlind) {
  MappedCamera camera(64);
  camera.move(0, kTurn);
  for (int i = 0; i < 40; ++i) camera.see(kDark);
  int frames = 0;
  for (int view = 30; view < 60; ++view) {
    camera.see(view);
    frames += camera.recognised == 0 ? 1 : 0;
  }
  std::printf("found after %d frames\n", frames);
  EXPECT_LT(frames, 10);
  camera.settle(60);
  say("carried", camera);
  EXPECT_GT(camera.recognised, 0);
  EXPECT_LT(camera.error_m(60), 0.1);
  EXPECT_GT((camera.result.T_world_camera.t - MappedCamera::truth(60).t).norm(), 0.3)
      << "the odometry does not know where it is";
  EXPECT_LT(std::sqrt(camera.in_map.pose_covariance(0, 0)), 0.1);
}

// The odometry does not know where the camera was carried to in a minute. As soon as the map recognises the
// place, it gives the pose.
TEST(Map, ACameraCarriedForAMinuteHasItsPlaceInTheFrameThatRecognisesIt) {
  MappedCamera camera(64);
  camera.move(0, kTurn);
  const int recognised = camera.recognised;
  for (int i = 0; i < 20; ++i) camera.see(kDark);
  camera.wait(1800);
  bool was_unknown = false;
  for (int view = 30; view < 60; ++view) {
    camera.see(view);
    if (camera.result.state != TrackState::kTracking) continue;
    const double sigma_m = std::sqrt(camera.in_map.pose_covariance(0, 0));
    if (camera.recognised == recognised) {
      was_unknown = true;
      EXPECT_GT(sigma_m, 1);
    } else {
      EXPECT_LT(camera.error_m(view), 0.1);
      EXPECT_LT(sigma_m, 0.1);
    }
  }
  EXPECT_TRUE(was_unknown);
  EXPECT_GT(camera.recognised, recognised);
}

// In hard light each frame may be a keyframe. The search for the place then goes on over many of them.
TEST(Map, FindsTheCameraWhereEachFrameIsAKeyframe) {
  MappedCamera camera(128, ReferencePolicy::kPreviousFrame);
  camera.move(0, kTurn);
  const int keyframes = camera.map.counts().keyframes;
  EXPECT_LT(keyframes, kTurn / 3) << "a view that is nearly the one before does not join";
  const int recognised = camera.recognised;
  camera.odometry.reset();
  int frames = 0;
  for (int view = 30; view < 60 && camera.recognised == recognised; ++view, ++frames) camera.see(view);
  std::printf("%d keyframes; found after %d frames\n", keyframes, frames);
  EXPECT_EQ(camera.map.counts().keyframes, keyframes + frames);
  EXPECT_LE(frames, 10);
  EXPECT_EQ(camera.wrong_loops(), 0);
}

// With 320×240 pixels two pairs are compared in a frame while the place is unknown, otherwise one.
TEST(Map, ComparesMoreInAFrameOfALargerImageWhileThePlaceIsUnknown) {
  ProceduralSequence sequence(320, 240);
  const Limits limits{320, 240, 250, 64, 2, 1, 0};
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  ASSERT_TRUE(odometry.init(memory, sequence.camera(), Config(), limits).ok());
  MapLimits map_limits;
  map_limits.keyframes = 32;
  std::vector<std::byte> map_memory(Map::required_bytes(map_limits, 320, 240));
  Map map;
  ASSERT_TRUE(map.init(map_memory, sequence.camera(), Config(), map_limits).ok());
  int taken = 0, most_if_known = 0, most_if_unknown = 0;
  bool located = true;
  const auto see = [&](int view) {
    RgbdFrame frame = sequence.render(view);
    frame.stamp_ns = frame.depth_stamp_ns = ProceduralSequence::stamp_ns(taken++);
    const int before = map.counts().compared;
    const bool was_located = located;
    located = map.update(odometry, odometry.track(frame)).located;
    int& most = was_located ? most_if_known : most_if_unknown;
    most = std::max(most, map.counts().compared - before);
  };
  for (int round = 0; round < 2; ++round) {
    for (int view = 0; view < kFar; ++view) see(view);
    for (int view = kFar; view > 0; --view) see(view);
  }
  odometry.reset();
  for (int view = 30; view < 40; ++view) see(view);
  EXPECT_TRUE(located);
  EXPECT_EQ(most_if_known, 1);
  EXPECT_EQ(most_if_unknown, 2);
}

// A full map removes a keyframe for each that joins. The one whose place is searched stays, and a place that
// many keyframes show is recognised as one that few show.
TEST(Map, AFullMapRecognisesPlacesRoundAfterRound) {
  MappedCamera camera(8, ReferencePolicy::kPreviousFrame);
  int recognised = 0;
  for (int round = 0; round < 4; ++round) {
    camera.move(0, kTurn);
    camera.move(kTurn, 0);
    std::printf("round %d: recognised %d times\n", round, camera.recognised - recognised);
    EXPECT_GT(camera.recognised - recognised, 10);
    recognised = camera.recognised;
  }
  say("full map", camera);
  EXPECT_EQ(camera.map.graph().size(), 8U);
  EXPECT_EQ(camera.wrong_loops(), 0);
}

TEST(Map, AfterAResetNothingIsKnownUntilAPlaceIsRecognised) {
  MappedCamera camera(64);
  camera.move(0, kTurn);
  camera.odometry.reset();
  camera.see(40);
  EXPECT_LT(camera.result.T_world_camera.t.norm(), 1e-9);
  EXPECT_GT(camera.in_map.pose_covariance(0, 0), 1e3);
  EXPECT_FALSE(camera.in_map.located);
  EXPECT_FALSE(camera.map.keyframe_pose(camera.in_map.keyframe));
  for (int view = 41; view < kTurn; ++view) {
    camera.see(view);
    ASSERT_EQ(camera.in_map.located, camera.recognised > 0);
    if (!camera.in_map.located) continue;
    // The new keyframes stand where they belong in the frame in which the place is recognised.
    ASSERT_LT(camera.error_m(view), 0.1);
    ASSERT_LT(camera.in_map.pose_covariance(0, 0), 0.01);
  }
  camera.settle(kTurn);
  EXPECT_GT(camera.recognised, 0);
  EXPECT_LT(camera.error_m(kTurn), 0.1);
  EXPECT_LT(camera.in_map.pose_covariance(0, 0), 0.01);
}

// The covariance of the caller's pose is larger than that of the world before: no sign that it goes on.
TEST(Map, AResetWithAPoseOfTheCallersStartsAnotherWorld) {
  MappedCamera camera(64);
  camera.move(0, kTurn);
  const std::uint32_t before = camera.in_map.keyframe;
  camera.odometry.reset();
  ASSERT_TRUE(camera.odometry.set_pose(Se3{}, Matrix6::Identity()).ok());
  camera.see(40);
  EXPECT_GT(camera.in_map.keyframe, before);
  EXPECT_FALSE(camera.in_map.located);
  EXPECT_GT(camera.in_map.pose_covariance(0, 0), 1e3);
}

TEST(Map, AnOdometryThatWasInitialisedAnewStartsAnotherWorld) {
  MappedCamera camera(64), anew(64);
  camera.move(0, kTurn);
  EXPECT_TRUE(camera.in_map.located);
  ASSERT_TRUE(anew.odometry.set_pose(Se3{}, Matrix6::Identity()).ok());
  anew.see(40);
  EXPECT_EQ(anew.result.world, camera.result.world) << "each counts from 0";
  EXPECT_FALSE(camera.map.update(anew.odometry, anew.result).located);
}

TEST(Map, APlaceThatOnlyLooksAlikeIsNotRecognised) {
  MappedCamera camera(64);
  for (int round = 0; round < 3; ++round) {
    camera.move(0, kTurn);
    camera.move(kTurn, 0);
  }
  camera.move(0, 50);
  const std::uint32_t last_of_the_first_room = camera.in_map.keyframe;
  const int compared = camera.map.counts().compared;
  // Wheels measure that the camera moves on by ten metres in the dark, into a room with the same walls.
  MotionPrior wheels;
  wheels.rotation.emplace().covariance *= 1e-8;
  wheels.translation.emplace().t_now_before = Vector3(0, 0, -0.25);
  wheels.translation->covariance *= 1e-6;
  for (int i = 0; i < 40; ++i) camera.see(kDark, wheels);
  camera.see(30, wheels);
  EXPECT_GT(camera.result.T_world_camera.t.norm(), 5);
  EXPECT_LT(camera.result.pose_covariance(0, 0), 0.1);
  camera.move(31, kTurn);
  camera.move(kTurn, 0);
  camera.settle(0);
  say("looks alike", camera);
  EXPECT_GT(camera.map.counts().compared, compared + 3) << "the views look alike";
  const PoseGraph& graph = camera.map.graph();
  for (const PoseGraph::Loop& loop : graph.loops())
    EXPECT_EQ(graph.node(loop.older).id <= last_of_the_first_room,
              graph.node(loop.newer).id <= last_of_the_first_room)
        << "a loop joins the two rooms";
}

TEST(Map, StaysWithinItsCapacityRoundAfterRound) {
  MappedCamera camera(12);
  std::vector<double> errors;
  for (int round = 0; round < 6; ++round) {
    camera.move(0, kFar);
    camera.move(kFar, 0);
    errors.push_back(camera.error_m(1));
  }
  camera.settle(0);
  say("full map", camera);
  EXPECT_EQ(camera.map.graph().size(), 12U);
  EXPECT_GT(camera.map.counts().removed, 12);
  EXPECT_EQ(camera.map.graph().node(camera.map.graph().slot_at(0)).id, 1U) << "the first keyframe stays";
  EXPECT_EQ(camera.wrong_loops(), 0);
  for (const double error : errors) std::printf("back after a round: %.1f mm\n", 1e3 * error);
  EXPECT_LT(camera.map_error_m(), camera.odometry_error_m());
}

// Every compiler, optimisation level and processor must give these bits. If a change of the odometry or of
// the map alters them on purpose, the new number stands in the message.
TEST(Map, GivesTheSameBitsEverywhere) {
  constexpr std::uint64_t kGolden = 3204652946650363987U;
  MappedCamera camera(12);
  Fingerprint bits;
  const auto look = [&](int view) {
    camera.see(view);
    bits.add(camera.in_map.T_map_world.R);
    bits.add(camera.in_map.T_map_world.t);
    bits.add(camera.in_map.pose_covariance);
  };
  for (int round = 0; round < 2; ++round) {
    for (int view = 0; view < kFar; ++view) look(view);
    for (int view = kFar; view > 0; --view) look(view);
  }
  EXPECT_GT(camera.recognised, 0);
  EXPECT_GT(camera.map.counts().removed, 0);
  EXPECT_EQ(bits.value(), kGolden);
}

TEST(Map, AKeyframeTakesAtMostTheStatedBytes) {
  for (const int keyframes : {8, 63, 64, 65, 255, 256, 257, 511, 512}) {
    MapLimits limits;
    limits.keyframes = keyframes;
    const std::size_t fixed = Map::required_bytes({8, 200, 64}, 640, 480) - 8 * Map::kKeyframeBytes;
    const std::size_t bytes = Map::required_bytes(limits, 640, 480);
    EXPECT_LE(bytes, fixed + static_cast<std::size_t>(keyframes) * Map::kKeyframeBytes) << keyframes;
    std::printf("%d keyframes: %.2f MiB\n", keyframes, static_cast<double>(bytes) / (1 << 20));
  }
}

TEST(Map, RefusesInvalidArguments) {
  const CameraModel camera;
  Map map;
  std::vector<std::byte> memory(100);
  EXPECT_EQ(map.init(memory, camera, Config(), {7, 200, 64}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(map.init(memory, camera, Config(), {64, 49, 64}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(map.init(memory, camera, Config(), {64, 200, 0}).code(), StatusCode::kInvalidArgument);
  const Status status = map.init(memory, camera, Config(), MapLimits());
  EXPECT_EQ(status.code(), StatusCode::kOutOfMemory);
  std::printf("%s\n", status.message());
  EXPECT_EQ(map.update(Odometry(), TrackResult()).keyframe, 0U) << "without an init it does nothing";
}

}  // namespace
}  // namespace plvo
