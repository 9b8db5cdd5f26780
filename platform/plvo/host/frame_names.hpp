// SPDX-License-Identifier: Apache-2.0
// The frames of what plvo writes, by name, with REP 103's suffix for x right, y down, z forward.
// docs/robot.md says how they become those of a robot.
#pragma once

namespace plvo {

inline constexpr const char* kWorldFrame = "world_optical";  // the camera of the first frame
inline constexpr const char* kCameraFrame = "camera_optical";

}  // namespace plvo
