// SPDX-License-Identifier: Apache-2.0
// What a calibration keeps of a recording: the depth images, the matched points and segments of pairs of
// frames, and the camera's motion. The odometry matches each frame with a keyframe: errors of the timing show
// more over the longer motion.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "plvo/base/match.hpp"
#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/lines/segment.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::calibrate {

struct TrackedFrame {
  std::int64_t stamp_ns = 0, depth_stamp_ns = 0;
  std::vector<std::uint16_t> depth;
  std::vector<Segment> segments;  // in the undistorted image
  Se3 T_world_camera;
  int stretch = -1;                    // the same for frames tracked without a gap; −1: lost
  Vector6 velocity = Vector6::Zero();  // per second, as in camera/exposure.hpp, from frames before and after
  bool velocity_known = false;
};

// A point observed at (u, v)[0] in the reference and at (u, v)[1] in the current frame, px.
struct PointPair {
  Vector2 reference, current;
};

struct FramePair {
  std::size_t reference = 0, current = 0;  // indices of the recording's frames
  std::vector<PointPair> points;
  std::vector<Match> lines;  // indices of the frames' segments
};

struct TrackedRecording {
  CameraModel camera;
  double metres_per_unit = 0;
  std::vector<TrackedFrame> frames;
  std::vector<FramePair> pairs;  // in increasing order of the current frame; both velocities are known
};

// Reads at most most_frames frames and calls on_frame before each. Returns an error if the odometry refuses
// the camera; damaged frames are skipped.
Status track_recording(RgbdCamera& source, const CameraModel& camera, std::size_t most_frames,
                       const std::function<void()>& on_frame, TrackedRecording& recording);

}  // namespace plvo::calibrate
