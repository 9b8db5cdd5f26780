// SPDX-License-Identifier: Apache-2.0
// Odometry of messages as ROS 1 serialises them: images, camera_info and readings of an IMU in, what
// nav_msgs/Odometry holds out. The message headers of Debian's ROS do not compile as C++20, and those of plvo
// do not as C++17: this header is valid in both, and includes neither.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace plvo {

// A message, and its type, like sensor_msgs/Image.
struct RosMessage {
  std::string type;
  std::vector<std::uint8_t> bytes;
};

// x y z in metres, and a unit quaternion x y z w.
struct RosPose {
  std::array<double, 3> position{};
  std::array<double, 4> orientation{0, 0, 0, 1};
};
// Row-major, x y z before the rotations about x y z.
using RosCovariance = std::array<double, 36>;

struct RosOdometrySettings {
  bool imu = false;                     // add_imu() is called
  bool level = false;                   // the z axis of odom points up, by the accelerometer
  double depth_units_per_metre = 1000;  // of 16UC1
  double stamp_sigma_s = 0;             // error of the colour stamps, standard deviation
};

// What came of a pair of images.
struct RosEstimate {
  std::int64_t stamp_ns = 0;
  bool has_pose = false;  // the members below are new
  RosPose pose;           // of the base, in odom
  RosCovariance pose_covariance{};
  // Mean velocity since the last pose: m/s, then rad/s, in the axes of the base. Where it was not measured it
  // is zero, and its variances are kUnknownTwistVariance.
  std::array<double, 6> twist{};
  RosCovariance twist_covariance{};

  // "initialising", "tracking", "lost" or "predicted"; "error" where the images cannot be tracked as they
  // are.
  std::string state;
  std::string reason;         // of plvo's status, empty if there is nothing to say
  int points = 0, lines = 0;  // that agree with the motion
};
inline constexpr double kUnknownTwistVariance = 1e6;

class RosOdometry {
 public:
  explicit RosOdometry(const RosOdometrySettings& settings);
  ~RosOdometry();

  // Functions that return a text say what is wrong, or nothing.

  // A sensor_msgs/CameraInfo. The first one counts until reset(), which takes the latest one.
  std::string set_camera(const RosMessage& camera_info);
  bool has_camera() const;
  // Where the camera, in optical axes, sits in the base. Call it before the first frame.
  std::string set_base_camera(const RosPose& T_base_camera);
  // Rotation from the axes of the IMU to those of the camera, x y z w.
  std::string set_imu_axes(const std::array<double, 4>& q_camera_imu);
  // A sensor_msgs/Imu. Its stamp is stored.
  std::string add_imu(const RosMessage& imu, std::int64_t& stamp_ns);

  // Images that belong together, sensor_msgs/Image or sensor_msgs/CompressedImage.
  RosEstimate track(const RosMessage& colour, const RosMessage& depth);

  // The next frame is the first one.
  void reset();
  // The pose of the base at the last frame that has one, with its covariance; before the first frame, at
  // that.
  std::string set_pose(const RosPose& T_odom_base, const RosCovariance& covariance);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace plvo
