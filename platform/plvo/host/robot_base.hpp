// SPDX-License-Identifier: Apache-2.0
// Poses of a robot instead of its camera's: T_base_camera says where the camera sits, and what was tracked is
// told of the base. With base_link in REP 103's axes (x forward, y left, z up) the world becomes odom of REP
// 105: the base at the first frame.
#pragma once

#include "plvo/odometry/track_result.hpp"

namespace plvo {

// Turns optical axes (x right, y down, z forward) to those of a body (x forward, y left, z up; REP 103).
Matrix3 rotation_body_optical();

// The pose is T_odom_base = T_odom_world · T_world_camera · T_base_camera⁻¹, the motion that of the base
// since the reference; covariances are carried along (first order), T_odom_world and T_base_camera being
// exact. The names of the members stay: T_world_camera is T_odom_base. All else is as it was.
TrackResult result_of_base(const TrackResult& result, const Se3& T_base_camera, const Se3& T_odom_world);
// Where odom is the base at the first frame, T_world_camera having been the identity.
inline TrackResult result_of_base(const TrackResult& result, const Se3& T_base_camera) {
  return result_of_base(result, T_base_camera, T_base_camera);
}

// T_odom_world of a level world (Config::level_world): odom has its z axis up, and its origin and heading are
// those of the base at the first pose.
Se3 level_odom(const Se3& T_world_camera, const Se3& T_base_camera);

}  // namespace plvo
