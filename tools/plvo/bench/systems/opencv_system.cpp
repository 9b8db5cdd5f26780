// SPDX-License-Identifier: Apache-2.0
// OpenCV's odometries (module rgbd of opencv-contrib), frame to frame with their default settings, as in the
// module's own evaluation sample: grey images, depth in metres with NaN for missing values, one frame object
// per frame whose cache is kept for its second use; a failure leaves the pose unchanged and continues with
// the next frame. Unlike the sample, the motion is estimated from the previous frame to the current one: this
// gives better results on our recordings.
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd/depth.hpp>

#include "plvo/bench/systems/ideal_images.hpp"
#include "plvo/bench/systems/system.hpp"

namespace plvo::bench {
namespace {

using OpencvOdometry = cv::Ptr<cv::rgbd::Odometry>;

OpencvOdometry make_odometry(const std::string& name, const cv::Mat& camera_matrix) {
  if (name == "opencv-icp") return cv::rgbd::ICPOdometry::create(camera_matrix);
  if (name == "opencv-rgbdicp") return cv::rgbd::RgbdICPOdometry::create(camera_matrix);
  return cv::rgbd::RgbdOdometry::create(camera_matrix);
}

class OpencvSystem final : public System {
 public:
  OpencvSystem(const std::string& name, const CameraModel& camera) : images_(camera) {
    cv::setNumThreads(1);
    const Pinhole& p = camera.pinhole;
    const cv::Matx33d K(p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1);
    odometry_ = make_odometry(name, cv::Mat(cv::Matx33f(K)));
  }

  void prepare(const RgbdFrame& frame) override {
    images_.make(frame);
    const cv::Mat rgb(images_.height(), images_.width(), CV_8UC3, images_.rgb());
    const cv::Mat raw(images_.height(), images_.width(), CV_16UC1, images_.depth());
    cv::Mat grey;
    cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
    cv::Mat depth;
    raw.convertTo(depth, CV_32FC1, frame.depth.metres_per_unit);
    depth.setTo(std::numeric_limits<float>::quiet_NaN(), raw == 0);
    current_ = cv::rgbd::OdometryFrame::create(grey, depth);
  }

  bool track() override {
    bool tracked = true;
    if (previous_) {
      cv::Mat motion;  // maps points: previous camera → current camera
      tracked = odometry_->compute(previous_, current_, motion);
      if (tracked) {
        Se3 T_current_previous;
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) T_current_previous.R(i, j) = motion.at<double>(i, j);
          T_current_previous.t(i) = motion.at<double>(i, 3);
        }
        T_world_camera_ = T_world_camera_ * T_current_previous.inverse();
        T_world_camera_.R = renormalise(T_world_camera_.R);
      }
    }
    previous_ = current_;
    return tracked;
  }

  Se3 pose() const override { return T_world_camera_; }

 private:
  OpencvOdometry odometry_;
  IdealImages images_;
  cv::Ptr<cv::rgbd::OdometryFrame> current_, previous_;
  Se3 T_world_camera_;
};

}  // namespace

std::unique_ptr<System> make_opencv_system(const std::string& name, const CameraModel& camera) {
  return std::make_unique<OpencvSystem>(name, camera);
}

std::string opencv_version() { return CV_VERSION; }

}  // namespace plvo::bench
