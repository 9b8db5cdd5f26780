// SPDX-License-Identifier: Apache-2.0
// For which frames the motion since the frame before gives a velocity.
#include "plvo/host/motion_twist.hpp"

#include <gtest/gtest.h>

namespace plvo {
namespace {

// Half a metre along x per frame, ten frames a second.
TrackResult frame(int i) {
  TrackResult result;
  result.state = TrackState::kTracking;
  result.stamp_ns = 100'000'000 * i;
  result.reference_stamp_ns = 100'000'000 * (i - 1);
  result.T_world_camera.t = Vector3(0.5 * i, 0, 0);
  result.motion_covariance = 1e-4 * Matrix6::Identity();
  return result;
}

TEST(MotionTwist, IsTheMotionSinceTheFrameBefore) {
  MotionTwist twist;
  EXPECT_FALSE(twist.of(frame(0))) << "nothing came before";
  const std::optional<Twist> measured = twist.of(frame(1));
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->velocity[0], 5, 1e-9);
  EXPECT_NEAR(measured->covariance(0, 0), 1e-2, 1e-9);
}

// A note on a tracked frame says nothing against its motion.
TEST(MotionTwist, IsMeasuredWhereTheStatusTellsOfAPartThatTravelsWithTheCamera) {
  MotionTwist twist;
  (void)twist.of(frame(0));
  TrackResult carried = frame(1);
  carried.status = {StatusCode::kOk, "a part of the image travels with the camera; its points are left out"};
  ASSERT_TRUE(twist.of(carried));
}

TEST(MotionTwist, IsUnknownWhereTheMotionWasNotMeasured) {
  for (bool TrackResult::*unmeasured : {&TrackResult::restarted, &TrackResult::relocalised}) {
    MotionTwist twist;
    (void)twist.of(frame(0));
    TrackResult result = frame(1);
    result.*unmeasured = true;
    EXPECT_FALSE(twist.of(result));
    EXPECT_TRUE(twist.of(frame(2)));
    result = frame(3);
    result.state = TrackState::kInitialising;
    EXPECT_FALSE(twist.of(result));
  }
}

}  // namespace
}  // namespace plvo
