// SPDX-License-Identifier: Apache-2.0
// What travels with the camera: dots that its projector throws on the scene, and a part of the robot in view.
// Without a pattern nothing is carried.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/math/cholesky.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "sound.hpp"

namespace plvo {
namespace {

constexpr int kImageWidth = 320, kImageHeight = 240;
constexpr int kRecordedFrames = 40;

// Changes the images of a frame.
using ImageChange = void (*)(std::vector<std::uint8_t>& colour, std::vector<std::uint16_t>& depth);

void no_change(std::vector<std::uint8_t>& /*colour*/, std::vector<std::uint16_t>& /*depth*/) {}

// Small bright blobs at random pixels, always the same ones, over a darker image.
void dots(std::vector<std::uint8_t>& colour, std::vector<std::uint16_t>& /*depth*/) {
  for (std::uint8_t& level : colour) level = static_cast<std::uint8_t>(level * 0.6);
  Random random(3);
  for (int dot = 0; dot < 1500; ++dot) {
    const int x = 1 + static_cast<int>(random.below(kImageWidth - 2));
    const int y = 1 + static_cast<int>(random.below(kImageHeight - 2));
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        for (int channel = 0; channel < 3; ++channel) {
          std::uint8_t& level =
              colour[static_cast<std::size_t>(3 * ((y + j) * kImageWidth + x + i) + channel)];
          level = static_cast<std::uint8_t>(std::min(level + (i == 0 && j == 0 ? 110 : 50), 255));
        }
  }
}

// A textured part of the robot, at 0.5 m, in the lowest fifth.
void bumper(std::vector<std::uint8_t>& colour, std::vector<std::uint16_t>& depth) {
  Random random(4);
  std::vector<std::uint8_t> tiles(40 * 10);
  for (std::uint8_t& tile : tiles) tile = static_cast<std::uint8_t>(40 + random.below(180));
  for (int y = kImageHeight * 4 / 5; y < kImageHeight; ++y)
    for (int x = 0; x < kImageWidth; ++x) {
      const auto pixel = static_cast<std::size_t>(y * kImageWidth + x);
      for (std::size_t channel = 0; channel < 3; ++channel)
        colour[3 * pixel + channel] = tiles[static_cast<std::size_t>(y / 8 % 10 * 40 + x / 8)];
      depth[pixel] = 500;
    }
}

struct Outcome {
  double worst_m = 0;     // largest error of a position
  double worst_nees = 0;  // of a position that is called tracked: squared, by the covariance of the pose
  int lost = 0;
  std::string told;
  int low_keypoints = 0;  // in the lowest fifth of the last image
};

Outcome track_with(ImageChange change) {
  ProceduralSequence sequence(kImageWidth, kImageHeight);
  const Limits limits{kImageWidth, kImageHeight};
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  const Status status = odometry.init(memory, sequence.camera(), Config(), limits);
  EXPECT_TRUE(status.ok()) << status.message();
  Outcome outcome;
  const Se3 T_first_world = ProceduralSequence::T_world_camera(0).inverse();
  for (int i = 0; i < kRecordedFrames; ++i) {
    RgbdFrame frame = sequence.render(i);
    std::vector<std::uint8_t> colour(frame.colour.data, frame.colour.data + 3 * kImageWidth * kImageHeight);
    std::vector<std::uint16_t> depth(frame.depth.data, frame.depth.data + kImageWidth * kImageHeight);
    change(colour, depth);
    frame.colour.data = colour.data();
    frame.depth.data = depth.data();
    const TrackResult result = odometry.track(frame);
    EXPECT_TRUE(test::is_sound(result)) << result.status.message();
    outcome.lost += i > 0 && result.state != TrackState::kTracking ? 1 : 0;
    if (std::string(result.status.message()).find("travels") != std::string::npos) {
      EXPECT_FALSE(result.restarted) << "the note says nothing of the motion";
      if (outcome.told.empty()) outcome.told = result.status.message();
    }
    const Vector3 error = result.T_world_camera.t - (T_first_world * ProceduralSequence::T_world_camera(i)).t;
    outcome.worst_m = std::max(outcome.worst_m, static_cast<double>(error.norm()));
    Cholesky<3> cholesky;
    if (i > 0 && result.state == TrackState::kTracking &&
        cholesky.factor(result.pose_covariance.block<3, 3>(0, 0)))
      outcome.worst_nees = std::max(outcome.worst_nees, error.dot(cholesky.inverse() * error));
  }
  for (const Keypoint& keypoint : odometry.features().keypoints)
    outcome.low_keypoints += keypoint.v >= kImageHeight * 4 / 5 ? 1 : 0;
  std::printf("%.1f mm, NEES %.1f, %d lost, %d keypoints in the lowest fifth; %s\n", 1e3 * outcome.worst_m,
              outcome.worst_nees, outcome.lost, outcome.low_keypoints, outcome.told.c_str());
  return outcome;
}

TEST(Carried, NothingIsCarriedWhereNothingTravelsWithTheCamera) {
  const Outcome outcome = track_with(no_change);
  EXPECT_EQ(outcome.told, "");
  EXPECT_LT(outcome.worst_m, 0.02);
  EXPECT_GT(outcome.low_keypoints, 0);
}

TEST(Carried, APartOfTheRobotIsLeftOutAndTold) {
  const Outcome outcome = track_with(bumper);
  EXPECT_NE(outcome.told.find("rows 180 to 239"), std::string::npos) << outcome.told;
  EXPECT_EQ(outcome.lost, 0);
  EXPECT_LT(outcome.worst_m, 0.02);
  EXPECT_LT(outcome.low_keypoints, 15);  // of 75: those of cells at the edge of the part
}

// The dots seem to be a world at rest, until enough of them lie on surfaces whose depths have changed. Left
// in, they would keep the camera where it began, half a metre beside the truth.
TEST(Carried, DotsOfAProjectorAreFoundByTheDepthBehindThem) {
  const Outcome outcome = track_with(dots);
  EXPECT_NE(outcome.told, "");
  EXPECT_LT(outcome.worst_m, 0.35);
  EXPECT_EQ(outcome.low_keypoints, 0);
}

}  // namespace
}  // namespace plvo
