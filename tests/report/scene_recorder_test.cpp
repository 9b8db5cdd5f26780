// SPDX-License-Identifier: Apache-2.0
// Tests the points and lines that the report keeps, on a rendered room whose walls are known.
#include "plvo/report/scene_recorder.hpp"

#include <gtest/gtest.h>

#include "procedural_sequence.hpp"

namespace plvo::report {
namespace {

class SceneRecorderTest : public ::testing::Test {
 protected:
  SceneRecorderTest() : memory_(required_bytes(Limits::vga())), room_(320, 240) {
    EXPECT_TRUE(odometry_.init(memory_, room_.camera()).ok());
    EXPECT_TRUE(odometry_.set_pose(ProceduralSequence::T_world_camera(0), Matrix6::Zero()).ok());
  }

  std::vector<std::byte> memory_;
  ProceduralSequence room_;
  Odometry odometry_;
  SceneRecorder recorder_;
};

TEST_F(SceneRecorderTest, AKeyframeIsTakenOnceAndInTheWorld) {
  recorder_.offer(odometry_);
  EXPECT_TRUE(recorder_.scene().points.empty()) << "there is no keyframe yet";
  ASSERT_TRUE(odometry_.track(room_.render(0)).status.ok());
  recorder_.offer(odometry_);
  const std::size_t points = recorder_.scene().points.size(), lines = recorder_.scene().lines.size();
  EXPECT_GT(points, 50u);
  EXPECT_GT(lines, 5u);
  recorder_.offer(odometry_);
  EXPECT_EQ(recorder_.scene().points.size(), points);
  // They are those of the keyframe, moved into the world.
  const Se3 T_camera_world = ProceduralSequence::T_world_camera(0).inverse();
  const CameraModel camera = room_.camera();
  for (const Vector3& p : recorder_.scene().points) {
    const Vector3 seen = T_camera_world * p;
    EXPECT_GT(seen.z(), 0.3);
    EXPECT_LT(std::abs(seen.x() / seen.z()), 0.55 * camera.width / camera.pinhole.fx);
  }
  odometry_.reset();  // the next frame is a keyframe
  odometry_.track(room_.render(40));
  recorder_.offer(odometry_);
  EXPECT_GT(recorder_.scene().points.size(), points) << "a later keyframe adds its own";
}

TEST_F(SceneRecorderTest, ALongRunStaysWithinItsBounds) {
  const std::size_t most = SceneRecorder::kMostPoints;
  std::size_t before = 0;
  bool thinned = false;
  for (int i = 0; i < 200 && !thinned; ++i) {
    odometry_.reset();  // so that every frame is a keyframe
    odometry_.track(room_.render(i));
    recorder_.offer(odometry_);
    const std::size_t now = recorder_.scene().points.size();
    ASSERT_LE(now, most);
    thinned = now < before;
    before = now;
  }
  ASSERT_TRUE(thinned);
  EXPECT_GE(before, most / 2 - 1000);
}

}  // namespace
}  // namespace plvo::report
