// SPDX-License-Identifier: Apache-2.0
// The map in the procedural room: places that come back, places that only look alike, a full map, memory and
// determinism.
#include "plvo/map/map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include "allocation_guard.hpp"
#include "fingerprint.hpp"
#include "plvo/math/symmetric_eigen.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr int kDark = -1;  // a view that shows nothing

// An odometry with a map beside it, in the room. Each frame shows the view that a test asks for.
class MappedCamera {
 public:
  explicit MappedCamera(int keyframes) {
    config_.references.max_lost_s = 0.06;
    memory_.resize(required_bytes(limits_));
    EXPECT_TRUE(odometry.init(memory_, sequence_.camera(), config_, limits_).ok());
    MapLimits limits;
    limits.keyframes = keyframes;
    map_memory_.resize(Map::required_bytes(limits, kWidth, kHeight));
    const Status status = map.init(map_memory_, sequence_.camera(), config_, limits);
    EXPECT_TRUE(status.ok()) << status.message();
  }

  void see(int view, const MotionPrior& prior = {}) {
    RgbdFrame frame = view == kDark ? sequence_.render_dark(0) : sequence_.render(view);
    frame.stamp_ns = frame.depth_stamp_ns = ProceduralSequence::stamp_ns(taken_++);
    AllocationGuard guard;
    result = odometry.track(frame, prior);
    in_map = map.update(odometry, result);
    allocations += guard.calls();
    guard.disarm();
    EXPECT_TRUE(in_map.T_map_world.is_finite() && in_map.pose_covariance.allFinite());
    EXPECT_GE(symmetric_eigen<6>(in_map.pose_covariance).values.minCoeff(), -1e-9);
    if (in_map.recognised) ++recognised;
    if (in_map.removed != 0) removed_[in_map.removed] = {in_map.removed_into, in_map.T_into_removed};
    if (view != kDark && in_map.keyframe != 0 && result.state == TrackState::kTracking)
      frames_.push_back({view, in_map.keyframe, in_map.T_keyframe_camera, result.T_world_camera});
  }
  void walk(int from, int to) {
    for (int view = from; view != to; view += from < to ? 1 : -1) see(view);
  }
  // Frames in which the map's work comes to an end.
  void settle(int view) {
    for (int i = 0; i < 200; ++i) see(view + (i + 1) % 2);
  }

  // Distance of the camera in the map to the truth; view 0 is the origin.
  double error_m(int view) const {
    return ((in_map.T_map_world * result.T_world_camera).t - truth(view).t).norm();
  }
  // Root mean square over all frames.
  double odometry_error_m() const {
    double sum = 0;
    for (const Seen& frame : frames_) sum += (frame.T_world_camera.t - truth(frame.view).t).squaredNorm();
    return std::sqrt(sum / static_cast<double>(frames_.size()));
  }
  double map_error_m() const {
    double sum = 0;
    for (const Seen& frame : frames_) {
      Se3 T = frame.T_keyframe_camera;
      std::uint32_t id = frame.keyframe;
      for (; removed_.count(id) != 0; id = removed_.at(id).first) T = removed_.at(id).second * T;
      sum += ((*map.keyframe_pose(id) * T).t - truth(frame.view).t).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(frames_.size()));
  }
  // Loops that are farther from the truth than their places are apart.
  int wrong_loops() const {
    int wrong = 0;
    for (const PoseGraph::Loop& loop : map.graph().loops()) {
      const Se3& a = map.graph().node(loop.older).T_map_keyframe;
      const Se3& b = map.graph().node(loop.newer).T_map_keyframe;
      if ((a.inverse() * b).t.norm() > 0 && (loop.T_older_newer.t - (a.inverse() * b).t).norm() > 0.1)
        ++wrong;
    }
    return wrong;
  }
  static Se3 truth(int view) {
    return ProceduralSequence::T_world_camera(0).inverse() * ProceduralSequence::T_world_camera(view);
  }

  Odometry odometry;
  Map map;
  TrackResult result;
  MapResult in_map;
  int recognised = 0;
  std::int64_t allocations = 0;

 private:
  struct Seen {
    int view;
    std::uint32_t keyframe;
    Se3 T_keyframe_camera, T_world_camera;
  };
  Limits limits_{kWidth, kHeight, 250, 64, 2, 1, 0};
  Config config_;
  std::vector<std::byte> memory_, map_memory_;
  ProceduralSequence sequence_{kWidth, kHeight};
  std::vector<Seen> frames_;
  std::map<std::uint32_t, std::pair<std::uint32_t, Se3>> removed_;
  int taken_ = 0;
};

void say(const char* what, const MappedCamera& camera) {
  const Map::Counts& counts = camera.map.counts();
  std::printf(
      "%s: %zu keyframes (%d removed), %d pairs compared, %d accepted, %d loops, recognised %d times; "
      "RMS error %.1f mm, in the map %.1f mm\n",
      what, camera.map.graph().size(), counts.removed, counts.compared, counts.accepted, counts.loops,
      camera.recognised, 1e3 * camera.odometry_error_m(), 1e3 * camera.map_error_m());
}

constexpr int kTurn = 70;  // views to the turning point
constexpr int kFar = 100;  // so near to a wall that the odometry loses its way for a moment

TEST(Map, CorrectsTheDriftWhereAPlaceComesBack) {
  MappedCamera camera(64);
  for (int round = 0; round < 3; ++round) {
    camera.walk(0, kFar);
    camera.walk(kFar, 0);
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
  camera.walk(0, kTurn);
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

TEST(Map, AfterAResetNothingIsKnownUntilAPlaceIsRecognised) {
  MappedCamera camera(64);
  camera.walk(0, kTurn);
  camera.odometry.reset();
  camera.see(40);
  EXPECT_LT(camera.result.T_world_camera.t.norm(), 1e-9);
  EXPECT_GT(camera.in_map.pose_covariance(0, 0), 1e3);
  camera.walk(41, kTurn);
  camera.settle(kTurn);
  EXPECT_GT(camera.recognised, 0);
  EXPECT_LT(camera.error_m(kTurn), 0.1);
  EXPECT_LT(camera.in_map.pose_covariance(0, 0), 0.01);
}

TEST(Map, APlaceThatOnlyLooksAlikeIsNotRecognised) {
  MappedCamera camera(64);
  for (int round = 0; round < 3; ++round) {
    camera.walk(0, kTurn);
    camera.walk(kTurn, 0);
  }
  camera.walk(0, 50);
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
  camera.walk(31, kTurn);
  camera.walk(kTurn, 0);
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
    camera.walk(0, kFar);
    camera.walk(kFar, 0);
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
  constexpr std::uint64_t kGolden = 11879344711269779490U;
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

TEST(Map, AKeyframeTakesNoMoreThanItSays) {
  for (const int keyframes : {8, 63, 64, 65, 255, 256, 257, 511, 512}) {
    MapLimits limits;
    limits.keyframes = keyframes;
    const std::size_t fixed = Map::required_bytes({8, 200, 64}, 640, 480) - 8 * Map::kKeyframeBytes;
    const std::size_t bytes = Map::required_bytes(limits, 640, 480);
    EXPECT_LE(bytes, fixed + static_cast<std::size_t>(keyframes) * Map::kKeyframeBytes) << keyframes;
    std::printf("%d keyframes: %.2f MiB\n", keyframes, static_cast<double>(bytes) / (1 << 20));
  }
}

TEST(Map, RefusesWhatItCannotUse) {
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
