// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/window/pose_with_covariance.hpp"

#include <gtest/gtest.h>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Gaussian;

Se3 random_pose(Gaussian& gaussian) { return {rotation_exp(gaussian.vector<3>()), gaussian.vector<3>()}; }

// The shifts of a pose, compared with poses that are moved by them.
TEST(PoseWithCovariance, ShiftsFollowThePose) {
  Gaussian gaussian(1);
  const double small = 1e-5;
  for (int trial = 0; trial < 20; ++trial) {
    PoseWithCovariance from;
    from.T_world_camera = random_pose(gaussian);
    const Se3 T_current_from = random_pose(gaussian);
    OfEachKind of_motion;
    for (int k = 0; k < kLandmarkKinds; ++k) {
      from.shifts.col(k) = small * gaussian.vector<6>();
      of_motion.col(k) = small * gaussian.vector<6>();
    }
    const PoseWithCovariance current = advance(from, T_current_from, Matrix6::Zero(), of_motion);
    for (int k = 0; k < kLandmarkKinds; ++k) {
      PoseWithCovariance shifted;
      shifted.T_world_camera = boxplus(from.T_world_camera, from.shifts.col(k));
      const Se3 T = boxplus(T_current_from, of_motion.col(k));
      const Vector6 shift =
          boxminus(advance(shifted, T, Matrix6::Zero()).T_world_camera, current.T_world_camera);
      EXPECT_LT((current.shifts.col(k) - shift).norm(), 1e-3 * small) << trial;
    }
  }
}

TEST(PoseWithCovariance, ShiftsAddUpAndNoiseAddsUpByItsSquares) {
  const Se3 forward{Matrix3::Identity(), {0, 0, -0.1}};
  const int frames = 100;
  OfEachKind of_motion = OfEachKind::Zero();
  of_motion(2, 0) = 0.001;
  PoseWithCovariance pose;
  for (int i = 0; i < frames; ++i) pose = advance(pose, forward, 1e-6 * Matrix6::Identity(), of_motion);
  EXPECT_NEAR(pose.covariance(2, 2), frames * 1e-6, 1e-9);
  EXPECT_NEAR(pose.shifts(2, 0), -frames * 0.001, 1e-9);
  EXPECT_NEAR(pose.total_covariance()(2, 2), frames * 1e-6 + 0.01, 1e-9);
}

}  // namespace
}  // namespace plvo
