// SPDX-License-Identifier: Apache-2.0
// A pose as one line of JSON, for programs that are not ours. Keys: stamp_ns, state, status, message, world,
// frame_id and child_frame_id (frames), position (m), orientation_xyzw, covariance (36 numbers,
// row-major: position, then orientation; axes of the world), points, lines. And what is said while there is
// no pose, so that whoever reads can tell a camera that stalls from a program that hangs.
#pragma once

#include <string>
#include <string_view>

#include "plvo/host/frame_names.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo {

// What a map knows of the camera, beside the pose of the odometry.
struct MapPose {
  bool located = false;  // otherwise T_map_world and the covariance have no meaning: null in JSON
  Se3 T_map_world;
  Matrix6 pose_covariance = Matrix6::Zero();  // of T_map_world · T_world_camera; axes of the map
  int loops = 0;                              // closed since the start
};

// With a map there is a further member: "map":{"located":…,"loops":…,"position":…,"orientation_xyzw":…,
// "covariance":…}.
std::string pose_json(const TrackResult& result, const FrameNames& frames = kCameraFrames,
                      const MapPose* map = nullptr);

// {"heartbeat":true,"state":"stalled","seconds_since_frame":1.2,"message":"…"}
struct Heartbeat {
  std::string_view state;          // "waiting", "running", "stalled", "unplugged" or "damaged"
  double seconds_since_frame = 0;  // negative while no frame has come yet: null in JSON
  std::string_view message;        // the camera's state in words
};
std::string heartbeat_json(const Heartbeat& heartbeat);

}  // namespace plvo
