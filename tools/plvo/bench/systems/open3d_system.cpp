// SPDX-License-Identifier: Apache-2.0
// Open3D's RGB-D odometry (open3d::pipelines::odometry) with its default options, from the previous frame to
// the current one: the hybrid term of brightness and depth (Park 2017). Open3D rebuilds the pyramids of both
// frames for every pair; its interface cannot keep them, so the measured time includes this. Only this file
// is built with aligned Eigen matrices, because it exchanges such matrices with Open3D.
#include <omp.h>
#include <open3d/Open3DConfig.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/pipelines/odometry/Odometry.h>

#include <cstring>
#include <exception>

#include "plvo/bench/systems/ideal_images.hpp"
#include "plvo/bench/systems/system.hpp"

namespace plvo::bench {
namespace {

namespace o3d = open3d;
namespace odometry = open3d::pipelines::odometry;

static_assert(alignof(Eigen::Matrix4d) == 16, "as in Open3D");

class Open3dSystem final : public System {
 public:
  explicit Open3dSystem(const CameraModel& camera) : images_(camera) {
    omp_set_num_threads(1);
    o3d::utility::SetVerbosityLevel(o3d::utility::VerbosityLevel::Error);
    const Pinhole& p = camera.pinhole;
    intrinsics_.SetIntrinsics(camera.width, camera.height, p.fx, p.fy, p.cx, p.cy);
  }

  void prepare(const RgbdFrame& frame) override {
    images_.make(frame);
    o3d::geometry::Image colour, depth;
    colour.Prepare(images_.width(), images_.height(), 3, 1);
    std::memcpy(colour.data_.data(), images_.rgb(), colour.data_.size());
    depth.Prepare(images_.width(), images_.height(), 1, 2);
    std::memcpy(depth.data_.data(), images_.depth(), depth.data_.size());
    current_ = o3d::geometry::RGBDImage::CreateFromColorAndDepth(
        colour, depth, 1 / frame.depth.metres_per_unit, options_.depth_max_, true);
  }

  bool track() override {
    const bool tracked = !previous_ || track_from(*previous_);
    previous_ = current_;
    return tracked;
  }

  Se3 pose() const override { return T_world_camera_; }

 private:
  // Open3D reports some failures by a flag and others by an exception.
  bool track_from(const o3d::geometry::RGBDImage& previous) {
    try {
      const auto [success, motion, information] =
          odometry::ComputeRGBDOdometry(previous, *current_, intrinsics_, Eigen::Matrix4d::Identity(),
                                        odometry::RGBDOdometryJacobianFromHybridTerm(), options_);
      if (!success || !motion.allFinite()) return false;
      Se3 T_current_previous;  // motion maps points: previous camera → current camera
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) T_current_previous.R(i, j) = motion(i, j);
        T_current_previous.t(i) = motion(i, 3);
      }
      T_world_camera_ = T_world_camera_ * T_current_previous.inverse();
      T_world_camera_.R = renormalise(T_world_camera_.R);
      return true;
    } catch (const std::exception&) {
      return false;
    }
  }

  IdealImages images_;
  odometry::OdometryOption options_;
  o3d::camera::PinholeCameraIntrinsic intrinsics_;
  std::shared_ptr<o3d::geometry::RGBDImage> current_, previous_;
  Se3 T_world_camera_;
};

}  // namespace

std::unique_ptr<System> make_open3d_system(const CameraModel& camera) {
  return std::make_unique<Open3dSystem>(camera);
}

std::string open3d_version() { return OPEN3D_VERSION; }

}  // namespace plvo::bench
