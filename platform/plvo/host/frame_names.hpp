// SPDX-License-Identifier: Apache-2.0
// The frames of what plvo writes, by name. docs/user/robots.md describes them.
#pragma once

namespace plvo {

struct FrameNames {
  const char* world;
  const char* body;
  const char* axes;    // of both
  const char* origin;  // of the world
};

// As tracked; the suffix is REP 103's for these axes.
inline constexpr FrameNames kCameraFrames = {"world_optical", "camera_optical", "x right, y down, z forward",
                                             "the first frame's camera"};
// As result_of_base() makes them (robot_base.hpp): REP 105's names.
inline constexpr FrameNames kLevelFrames = {"world_optical", "camera_optical", "x right, y down, z forward",
                                            "the first frame's camera, turned level: gravity along y"};
inline constexpr FrameNames kBaseFrames = {"odom", "base_link", "x forward, y left, z up",
                                           "the base at the first frame"};
inline constexpr FrameNames kLevelBaseFrames = {
    "odom", "base_link", "x forward, y left, z up",
    "the base at the first frame, turned level: gravity along -z"};

}  // namespace plvo
