// SPDX-License-Identifier: Apache-2.0
// Simulated sequences that are hard for an odometry, with default settings (docs/user/simulator.md).
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "tracked_sequence.hpp"

namespace plvo {
namespace {

// Bound on the NEES of the motion of any tracked frame, which has six degrees of freedom.
constexpr double kNeesBound = 20;

struct HardSequence {
  int tracked = 0, lost = 0, repeated = 0;
  double error_m = 0;       // the largest of a position
  double nees = 0;          // the largest of the motion of a tracked frame
  int false_poses = 0;      // tracked frames whose pose has a NEES beyond the bound
  double disagreement = 1;  // the largest of points, lines and surfaces
  int in_doubt = 0;         // tracked frames whose status says that depth contradicts parallax
};

SimulatorOptions hard_options(int frames, std::initializer_list<const char*> names) {
  SimulatorOptions options = test::qvga_options(SceneName::kCorridor, frames);
  for (const char* name : names) EXPECT_TRUE(add_difficulty(name, options.difficulties).ok()) << name;
  return options;
}

HardSequence track_hard(const SimulatorOptions& options, const Limits& limits = test::kTestLimits) {
  const test::TrackedSequence tracked = test::track_sequence(options, limits, Config{});
  HardSequence figures;
  for (std::size_t i = 0; i < tracked.results.size(); ++i) {
    const TrackResult& result = tracked.results[i];
    figures.lost += result.state == TrackState::kLost ? 1 : 0;
    figures.repeated += result.repeated ? 1 : 0;
    const Vector3 position = (tracked.truth.front().inverse() * tracked.truth[i]).t;
    figures.error_m = std::max(figures.error_m, (result.T_world_camera.t - position).norm());
    if (result.state != TrackState::kTracking) continue;
    figures.disagreement = std::max(figures.disagreement, result.disagreement);
    ++figures.tracked;
    figures.in_doubt +=
        std::string_view(result.status.message()).starts_with("depth contradicts parallax") ? 1 : 0;
    figures.nees = std::max(figures.nees, tracked.nees_of_motion(i));
    figures.false_poses += tracked.nees_of_pose(i) > kNeesBound ? 1 : 0;
  }
  return figures;
}

// Depth of every second row and column is missing.
TEST(HardSequences, ACombInDepthIsTrackedAsDepthWithoutHoles) {
  const HardSequence comb = track_hard(hard_options(60, {"comb"}));
  EXPECT_EQ(comb.tracked, 59);
  EXPECT_LT(comb.error_m, 0.008);
  EXPECT_LT(comb.nees, kNeesBound);
  EXPECT_LT(comb.disagreement, 20) << "the room stands still";
  EXPECT_EQ(comb.in_doubt, 0);
}

TEST(HardSequences, RepeatedFramesArePassedOver) {
  SimulatorOptions options = hard_options(60, {"repeated-frames"});
  options.fps = 60;
  const HardSequence repeated = track_hard(options);
  EXPECT_EQ(repeated.repeated, 30);
  EXPECT_EQ(repeated.lost, 0);
  EXPECT_LT(repeated.error_m, 0.008);
  EXPECT_LT(repeated.nees, kNeesBound);
}

// Frames are tracked until it is certain that depth stands still. Then they are lost.
TEST(HardSequences, FramesWithFrozenDepthAreLost) {
  const HardSequence frozen = track_hard(hard_options(45, {"frozen-depth"}));
  EXPECT_GE(frozen.tracked, 20);
  EXPECT_GE(frozen.lost, 15);
  EXPECT_LT(frozen.nees, kNeesBound);
}

// The motion is a compromise between the room and dots that the camera carries along. The covariance contains
// its error, because points and lines disagree.
TEST(HardSequences, TheCovarianceContainsACompromiseWithDots) {
  SimulatorOptions options = hard_options(60, {"dots"});
  options.scene = SceneName::kDesk;
  const HardSequence dots = track_hard(options);
  EXPECT_EQ(dots.tracked, 59);
  EXPECT_LE(dots.false_poses, 6);
}

HardSequence track_before_a_mirror(SceneName scene, std::uint64_t seed) {
  Limits limits = test::kTestLimits;
  limits.surfaces = 200;
  SimulatorOptions options = hard_options(60, {"mirror"});
  options.scene = scene;
  options.seed = seed;
  return track_hard(options, limits);
}

// What is seen in a mirror lies behind its depth, so the depths of the points contradict their parallax. The
// motion follows depth then. By parallax alone the mean error is 84 mm.
TEST(HardSequences, DepthDecidesBeforeAMirror) {
  double mean_m = 0;
  int in_doubt = 0;
  for (const std::uint64_t seed : {1, 3, 5, 7}) {
    const HardSequence mirror = track_before_a_mirror(SceneName::kCorridor, seed);
    std::printf("seed %d: %.1f mm\n", static_cast<int>(seed), 1e3 * mirror.error_m);
    EXPECT_EQ(mirror.tracked, 59);
    EXPECT_LE(mirror.false_poses, 6);
    mean_m += mirror.error_m / 4;
    in_doubt += mirror.in_doubt;
  }
  EXPECT_LT(mean_m, 0.07);
  EXPECT_GT(in_doubt, 10);
}

// In a wide room the mirror is far away, and the noise of depth hides the contradiction. The motion is a
// compromise between the room and the mirror. The covariance contains its error, because it contains what
// points, lines and surfaces say apart.
TEST(HardSequences, TheCovarianceContainsACompromiseWithAMirror) {
  const HardSequence mirror = track_before_a_mirror(SceneName::kHall, 5);
  EXPECT_EQ(mirror.tracked, 59);
  EXPECT_LE(mirror.false_poses, 6);
  EXPECT_GT(mirror.disagreement, 30);
}

void expect_rest_before_a_board(SceneName scene, std::uint64_t seed, double most_m) {
  SimulatorOptions options = hard_options(60, {"board"});
  options.scene = scene;
  options.seed = seed;
  options.still = true;
  const HardSequence board = track_hard(options);
  EXPECT_EQ(board.tracked, 59);
  EXPECT_LT(board.error_m, most_m);
  EXPECT_LT(board.nees, kNeesBound);
}

// The desk has texture beside the board. Before barer walls, with as few features as here, the error may
// reach centimetres.
TEST(HardSequences, ACameraThatStandsStillAtADeskDoesNotFollowABoard) {
  expect_rest_before_a_board(SceneName::kDesk, 1, 0.003);
}

// Here the board, which comes into view at once, explains more than the corridor does. But the corridor's
// landmarks are proven.
TEST(HardSequences, ACameraThatStandsStillInACorridorDoesNotFollowABoard) {
  expect_rest_before_a_board(SceneName::kCorridor, 8, 0.005);
}

void expect_the_room_behind_a_board(SceneName scene, std::initializer_list<std::uint64_t> seeds,
                                    double most_m) {
  for (const std::uint64_t seed : seeds) {
    SimulatorOptions options = hard_options(60, {"board"});
    options.scene = scene;
    options.seed = seed;
    options.robot = true;
    const HardSequence board = track_hard(options);
    std::printf("seed %d: %.1f mm\n", static_cast<int>(seed), 1e3 * board.error_m);
    EXPECT_EQ(board.tracked, 59);
    EXPECT_LT(board.error_m, most_m);
  }
}

// Lines along which the board moves agree with the motion of the room (neighbourhoods.hpp).
TEST(HardSequences, ARobotThatMovesAtADeskDoesNotFollowABoard) {
  expect_the_room_behind_a_board(SceneName::kDesk, {6, 9}, 0.01);
}

// The board brings new landmarks, ten times as many as the corridor has. Before they have agreed for some
// frames, those of the corridor decide (motion_estimator.hpp).
TEST(HardSequences, ARobotThatMovesInACorridorDoesNotFollowABoard) {
  expect_the_room_behind_a_board(SceneName::kCorridor, {8, 9}, 0.05);
}

// A person goes ahead of the camera. From one frame to the next their landmarks agree with a motion between
// both. With one agreement as proof (LandmarkRecord::kProven) the mean error is 70 mm.
TEST(HardSequences, APersonAheadInACorridorIsNotFollowed) {
  double mean_m = 0;
  for (const std::uint64_t seed : {20, 22, 24, 26}) {
    SimulatorOptions options = hard_options(60, {"person-ahead"});
    options.seed = seed;
    const HardSequence person = track_hard(options);
    std::printf("seed %d: %d false poses, %.1f mm\n", static_cast<int>(seed), person.false_poses,
                1e3 * person.error_m);
    EXPECT_EQ(person.tracked, 59);
    EXPECT_EQ(person.false_poses, 0);
    mean_m += person.error_m / 4;
  }
  EXPECT_LT(mean_m, 0.03);
}

// A board moves before a corridor in which the light goes out. The board is lit and has most of the features,
// and those agree with each other. But none of the landmarks that agreed with the camera's motion is found.
TEST(HardSequences, AViewWithoutTheProvenLandmarksIsNotTracked) {
  constexpr std::size_t kDark = 34;
  constexpr double kBehindTheBoard_m = 1.6;
  for (const std::uint64_t seed : {5, 7}) {
    SimulatorOptions options = hard_options(static_cast<int>(kDark) + 1, {"board"});
    options.seed = seed;
    std::vector<std::uint8_t> colour;
    const auto switch_off = [&](RgbdFrame& frame, std::size_t i) {
      if (i < kDark) return;
      ASSERT_EQ(frame.colour.format, PixelFormat::kRgb8);
      const auto bytes = static_cast<std::size_t>(frame.colour.stride_bytes * frame.colour.height);
      colour.assign(frame.colour.data, frame.colour.data + bytes);
      for (int y = 0; y < frame.colour.height; ++y)
        for (int x = 0; x < frame.colour.width; ++x) {
          const double depth_m = frame.depth.metres_per_unit * frame.depth.data[y * frame.depth.stride + x];
          if (depth_m > 0 && depth_m < kBehindTheBoard_m) continue;
          std::uint8_t* const pixel = colour.data() + y * frame.colour.stride_bytes + 3 * x;
          for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(pixel[c] / 50);
        }
      frame.colour.data = colour.data();
    };
    const test::TrackedSequence tracked =
        test::track_sequence(options, test::kTestLimits, Config{}, 0, switch_off);
    ASSERT_EQ(tracked.results.size(), kDark + 1);
    EXPECT_EQ(tracked.results[kDark - 1].state, TrackState::kTracking);
    EXPECT_GT(tracked.results[kDark].points.matched, 100) << "the board is in view";
    EXPECT_EQ(tracked.results[kDark].state, TrackState::kLost);
  }
}

// Nine of ten points lie on the part of the robot and say that the camera stands still. What little is seen
// of the bare hall says that it moves.
TEST(HardSequences, APartOfTheRobotInABareHallIsNotTakenForRest) {
  for (const std::uint64_t seed : {8, 9, 10}) {
    SimulatorOptions options = hard_options(40, {"bumper"});
    options.scene = SceneName::kHall;
    options.seed = seed;
    options.robot = true;
    const HardSequence part = track_hard(options);
    std::printf("seed %d: %d tracked, %d false poses, %.0f mm\n", static_cast<int>(seed), part.tracked,
                part.false_poses, 1e3 * part.error_m);
    EXPECT_GE(part.tracked, 10);
    EXPECT_LE(part.false_poses, 3);
  }
}

}  // namespace
}  // namespace plvo
