// SPDX-License-Identifier: Apache-2.0
// An odometry under test, ours or a peer. A peer that takes other images than the sensor's (undistorted, in
// metres, grey) gets them in prepare(), which is not timed; what it computes from them is.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::bench {

class System {
 public:
  virtual ~System() = default;
  // The frame's views stay valid until the next call.
  virtual void prepare(const RgbdFrame& frame) = 0;
  // False when the frame is lost. The first frame never is.
  virtual bool track() = 0;
  // Of the last frame, T_world_camera; while lost, the last good one.
  virtual Se3 pose() const = 0;
};

// "plvo-points", "plvo-lines", "plvo-both", the same with "-paper" behind for the paper's settings; and,
// where its libraries were there when this was built, "opencv-rgbd", "opencv-icp", "opencv-rgbdicp" and
// "open3d-hybrid".
const std::vector<std::string>& system_names();
// Names and the groups "all", "ours", "paper", "opencv", "open3d", "peers", separated by commas, in the order
// given and each once. kInvalidArgument, listing the names there are.
Status parse_systems(const std::string& text, std::vector<std::string>& names);

Status make_system(const std::string& name, const CameraModel& camera, std::unique_ptr<System>& system);

// For the factory: null without OpenCV.
std::unique_ptr<System> make_opencv_system(const std::string& name, const CameraModel& camera);
// "4.6.0", or empty.
std::string opencv_version();
// For the factory: null without Open3D.
std::unique_ptr<System> make_open3d_system(const CameraModel& camera);
std::string open3d_version();

}  // namespace plvo::bench
