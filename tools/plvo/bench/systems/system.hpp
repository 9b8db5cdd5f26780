// SPDX-License-Identifier: Apache-2.0
// An odometry under test: plvo or another system. A system that needs other images than the sensor's
// (undistorted, in metres, grey) converts them in prepare(), which is not timed; its computations on them
// are.
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
  // Returns false if the frame is lost. The first frame is never lost.
  virtual bool track() = 0;
  // T_world_camera of the last frame; while tracking is lost, the last valid pose.
  virtual Se3 pose() const = 0;
};

// "plvo-points", "plvo-lines", "plvo-both"; the same with the suffix "-paper" for the paper's settings; and,
// if their libraries were present at build time, "opencv-rgbd", "opencv-icp", "opencv-rgbdicp" and
// "open3d-hybrid".
const std::vector<std::string>& system_names();
// `words` are names and the groups "all", "ours", "paper", "opencv", "open3d", "peers". Lists each system
// once, in the order of the words. Returns kInvalidArgument with the known names for an unknown word.
Status parse_systems(const std::vector<std::string>& words, std::vector<std::string>& names);

Status make_system(const std::string& name, const CameraModel& camera, std::unique_ptr<System>& system);

// Used by make_system(); null without OpenCV.
std::unique_ptr<System> make_opencv_system(const std::string& name, const CameraModel& camera);
// "4.6.0", or an empty string without OpenCV.
std::string opencv_version();
// Used by make_system(); null without Open3D.
std::unique_ptr<System> make_open3d_system(const CameraModel& camera);
std::string open3d_version();

}  // namespace plvo::bench
