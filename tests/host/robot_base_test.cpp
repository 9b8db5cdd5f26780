// SPDX-License-Identifier: Apache-2.0
// A camera's poses told of the robot's base, against numbers worked out by hand and against a cloud of
// perturbed poses.
#include "plvo/host/robot_base.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/math/trigonometry.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

// A camera that looks ahead, 0.2 m in front of the base and 0.5 m above it.
Se3 ahead() {
  Se3 T_base_camera{to_rotation({-0.5, 0.5, -0.5, 0.5}), Vector3(0.2, 0, 0.5)};
  return T_base_camera;
}
Se3 tilted() {
  return {to_rotation({-0.5, 0.5, -0.5, 0.5}) * rotation_exp({-0.3, 0.1, 0.2}), Vector3(0.3, -0.1, 0.4)};
}

TEST(RobotBase, AxesAreThoseOfRep103) {
  TrackResult result;
  result.T_world_camera.t = Vector3(0.1, 0.2, 3);  // right, down, forward
  const TrackResult base = result_of_base(result, ahead());
  EXPECT_LT((base.T_world_camera.t - Vector3(3, -0.1, -0.2)).norm(), 1e-12) << "forward, left, up";
  EXPECT_LT((base.T_world_camera.R - Matrix3::Identity()).norm(), 1e-12);
}

TEST(RobotBase, ARobotThatTurnsOnTheSpotStaysThere) {
  // The robot turns left by 90°; the camera in front of it goes along an arc.
  const Se3 turned{rotation_exp({0, 0, kPi / 2}), Vector3::Zero()};
  TrackResult result;
  result.T_world_camera = ahead().inverse() * turned * ahead();
  EXPECT_GT(result.T_world_camera.t.norm(), 0.2);
  const TrackResult base = result_of_base(result, ahead());
  EXPECT_LT(base.T_world_camera.t.norm(), 1e-12);
  EXPECT_LT((base.T_world_camera.R - turned.R).norm(), 1e-12);
}

// A camera mounted askew on a robot that stands on a slope: in the level world odom's z points up, its origin
// is the base, and its x points where the base does, seen from above.
TEST(RobotBase, OfALevelWorldOdomIsLevel) {
  Matrix3 R_up_optical;  // body axes of the optical ones, both level
  R_up_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Se3 T_up_base{rotation_exp({0, 0, 0.7}) * rotation_exp({0.1, -0.2, 0}), Vector3(5, 6, 7)};
  const Se3 T_world_up{R_up_optical.transpose(), Vector3(-1, 2, 0.5)};
  TrackResult result;
  result.T_world_camera = T_world_up * T_up_base * tilted();
  const Se3 T_odom_world = level_odom(result.T_world_camera, tilted());
  const TrackResult base = result_of_base(result, tilted(), T_odom_world);
  EXPECT_LT(base.T_world_camera.t.norm(), 1e-12);
  EXPECT_LT(
      (base.T_world_camera.R.transpose() * Vector3(0, 0, 1) - T_up_base.R.transpose() * Vector3(0, 0, 1))
          .norm(),
      1e-12)
      << "up is up, seen from the base";
  EXPECT_NEAR(base.T_world_camera.R(1, 0), 0, 1e-12);
  EXPECT_GT(base.T_world_camera.R(0, 0), 0.9) << "ahead";
  // One metre up the hill.
  const Se3 T_up_later{T_up_base.R, T_up_base.t + Vector3(0, 0, 1)};
  result.T_world_camera = T_world_up * T_up_later * tilted();
  const TrackResult later = result_of_base(result, tilted(), T_odom_world);
  EXPECT_LT((later.T_world_camera.t - Vector3(0, 0, 1)).norm(), 1e-12);
}

TEST(RobotBase, TheMotionIsThatOfTheBase) {
  const Se3 T_odom_before{rotation_exp({0.1, -0.2, 0.3}), Vector3(1, 2, 0)};
  const Se3 T_odom_now{rotation_exp({0.1, -0.1, 0.5}), Vector3(1.2, 2.1, 0)};
  TrackResult result;
  const Se3 T_camera_base = tilted().inverse();
  result.T_camera_reference = T_camera_base * (T_odom_now.inverse() * T_odom_before) * tilted();
  const TrackResult base = result_of_base(result, tilted());
  EXPECT_LT(boxminus(base.T_camera_reference, T_odom_now.inverse() * T_odom_before).norm(), 1e-12);
}

TEST(RobotBase, ADriftOfTheCamerasAngleIsALeversAtTheBase) {
  // Only the camera's pitch is unsure, about its x, by 1 mrad. The base 0.5 m below and 0.2 m behind it moves
  // with it as on a lever, ω × r, and turns about its -y.
  TrackResult result;
  result.pose_covariance(3, 3) = 1e-6;
  const Matrix6 c = result_of_base(result, ahead()).pose_covariance;
  Matrix6 expected = Matrix6::Zero();
  // ω = (0, -1e-3, 0) in odom; from the camera to the base r = (-0.2, 0, -0.5): ω × r = 1e-3 (0.5, 0, -0.2).
  Vector6 direction;
  direction << 0.5, 0, -0.2, 0, -1, 0;
  expected = 1e-6 * direction * direction.transpose();
  EXPECT_LT((c - expected).norm(), 1e-15) << c;
}

TEST(RobotBase, CovariancesAreThoseOfACloudOfPoses) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  Matrix6 A;
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = normal(generator);
  TrackResult result;
  result.T_world_camera = {rotation_exp({0.4, -0.7, 0.2}), Vector3(2, -1, 3)};
  result.T_camera_reference = {rotation_exp({0.1, 0.05, -0.2}), Vector3(0.1, 0.2, -0.3)};
  result.pose_covariance = 1e-8 * A * A.transpose();
  result.motion_covariance = 2e-8 * A.transpose() * A;
  const TrackResult base = result_of_base(result, tilted());
  const auto cloud = [&](const Se3& T, const Matrix6& covariance, const Se3& T_base) {
    const Eigen::Matrix<double, 6, 6> dense = covariance;
    const Eigen::Matrix<double, 6, 6> root = dense.llt().matrixL();
    Matrix6 sum = Matrix6::Zero();
    constexpr int kDraws = 40000;
    for (int i = 0; i < kDraws; ++i) {
      Eigen::Matrix<double, 6, 1> white;
      for (int k = 0; k < 6; ++k) white[k] = normal(generator);
      const Vector6 delta = root * white;
      const Vector6 moved = boxminus(tilted() * boxplus(T, delta) * tilted().inverse(), T_base);
      sum += moved * moved.transpose();
    }
    return Matrix6(sum / kDraws);
  };
  const Matrix6 pose = cloud(result.T_world_camera, result.pose_covariance, base.T_world_camera);
  EXPECT_LT((base.pose_covariance - pose).norm(), 0.02 * pose.norm());
  const Matrix6 motion = cloud(result.T_camera_reference, result.motion_covariance, base.T_camera_reference);
  EXPECT_LT((base.motion_covariance - motion).norm(), 0.02 * motion.norm());
  EXPECT_GT((base.pose_covariance - result.pose_covariance).norm(), 0.2 * pose.norm());
}

TEST(RobotBase, FilesSayItsFrames) {
  const test::TemporaryFolder folder;
  TrajectoryFile trajectory;
  MotionFile motions;
  ASSERT_TRUE(trajectory.open(folder / "t", kBaseFrames).ok());
  ASSERT_TRUE(motions.open(folder / "m", kBaseFrames).ok());
  EXPECT_TRUE(test::read_file(folder / "t")
                  .ends_with("; frame_id: odom, child_frame_id: base_link (x forward, y left, z up; the "
                             "world is the base at the first "
                             "frame)\n"))
      << test::read_file(folder / "t");
  EXPECT_TRUE(test::read_file(folder / "m")
                  .ends_with("; frame_id: base_link, child_frame_id: base_link at the reference_timestamp (x "
                             "forward, y left, z up)\n"))
      << test::read_file(folder / "m");
}

}  // namespace
}  // namespace plvo
