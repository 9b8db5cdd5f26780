// SPDX-License-Identifier: Apache-2.0
// With `--base-camera` the pose of the map is that of the robot's base, in a level world too.
#include "plvo/cli/options/base_option.hpp"

#include <gtest/gtest.h>

#include "plvo/host/robot_base.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::cli {
namespace {

const Vector3 kUp(0, 0, 1);

// A camera that looks ahead and 20° down, 0.2 m before the base and 0.5 m above it.
Se3 mounted() { return {rotation_exp({0, 0.35, 0}) * rotation_body_optical(), Vector3(0.2, 0, 0.5)}; }

BaseOption option_of(bool level) {
  BaseOption option;
  option.level = level;
  option.T_base_camera = mounted();
  return option;
}

// A frame of a base that stands upright, has turned left by `heading` and stands at `place`, in a level world
// of the odometry: its y axis points down.
TrackResult tracked(double heading, const Vector3& place) {
  const Se3 T_world_up{rotation_body_optical().transpose(), Vector3::Zero()};  // from axes with z up
  TrackResult result;
  result.state = TrackState::kTracking;
  result.T_world_camera = T_world_up * Se3{rotation_exp({0, 0, heading}), place} * mounted();
  return result;
}
TrackResult first_frame() { return tracked(0, Vector3::Zero()); }

struct Seen {
  TrackResult result, of_base;
  MapPose map, map_of_base;
};

// The map is turned about gravity and lies elsewhere.
Seen see(bool level) {
  BaseOption option = option_of(level);
  (void)option.apply(first_frame());
  Seen seen;
  seen.result = tracked(0.7, {1, 2, 0});
  seen.map.located = true;
  seen.map.T_map_world = {rotation_exp({0, -0.4, 0}), Vector3(3, 0.1, -2)};
  Matrix6 root;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) root(r, c) = 1e-3 * (r == c ? 3 + r : (r * 5 + c * 3) % 4 - 1.5);
  seen.map.pose_covariance = root * root.transpose();
  seen.of_base = option.apply(seen.result);
  seen.map_of_base = option.apply(seen.map, seen.result);
  return seen;
}

TEST(BaseOption, ThePoseInTheMapIsThatOfTheBase) {
  for (const bool level : {false, true}) {
    const Seen seen = see(level);
    const Se3 T_map_camera = seen.map.T_map_world * seen.result.T_world_camera;
    const Se3 T_map_base = seen.map_of_base.T_map_world * seen.of_base.T_world_camera;
    // The distance between two frames of the map does not depend on its axes: the camera sits in the base as
    // before.
    const TrackResult origin = first_frame();
    const Se3 T_map_origin = seen.map_of_base.T_map_world * option_of(level).apply(origin).T_world_camera;
    const Se3 moved = T_map_origin.inverse() * T_map_base;
    const Se3 expected = mounted() * (seen.map.T_map_world * origin.T_world_camera).inverse() * T_map_camera *
                         mounted().inverse();
    EXPECT_LT(boxminus(moved, expected).norm(), 1e-9) << level;
    EXPECT_LT((moved.t - Vector3(1, 2, 0)).norm(), 1e-9) << level;
  }
}

TEST(BaseOption, InALevelWorldTheMapIsLevelToo) {
  const Seen seen = see(true);
  EXPECT_LT((seen.of_base.T_world_camera.R * kUp - kUp).norm(), 1e-9);
  EXPECT_LT((seen.map_of_base.T_map_world.R * kUp - kUp).norm(), 1e-9);
  // Turned by −0.4 rad about the axis that points down, and so by 0.4 rad about the one that points up.
  EXPECT_LT((seen.map_of_base.T_map_world.R - rotation_exp({0, 0, 0.4})).norm(), 1e-9);
}

// The covariance is compared with differences: the pose of the camera is moved by a little in each direction.
TEST(BaseOption, TheCovarianceInTheMapIsThatOfTheBase) {
  for (const bool level : {false, true}) {
    const Seen seen = see(level);
    const Se3 T_map_camera = seen.map.T_map_world * seen.result.T_world_camera;
    const Se3 T_map_base = seen.map_of_base.T_map_world * seen.of_base.T_world_camera;
    const Se3 T_axes = T_map_base * mounted() * T_map_camera.inverse();
    constexpr double kStep = 1e-6;
    Matrix6 J;
    for (int i = 0; i < 6; ++i) {
      Vector6 step = Vector6::Zero();
      step[i] = kStep;
      J.col(i) = boxminus(T_axes * boxplus(T_map_camera, step) * mounted().inverse(), T_map_base) / kStep;
    }
    const Matrix6 expected = J * seen.map.pose_covariance * J.transpose();
    EXPECT_LT((seen.map_of_base.pose_covariance - expected).norm(), 1e-4 * expected.norm()) << level;
  }
}

}  // namespace
}  // namespace plvo::cli
