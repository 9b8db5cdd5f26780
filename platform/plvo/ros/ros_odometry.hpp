// SPDX-License-Identifier: Apache-2.0
// Odometry of ROS's messages: images, camera_info and readings of an IMU in, what nav_msgs/Odometry holds
// out. Messages of ROS 1 come as roscpp received them, those of ROS 2 by their fields. The message headers of
// Debian's ROS 1 do not compile as C++20, and those of plvo do not as C++17: this header is valid in both,
// and includes neither.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "plvo/c/plvo.h"

namespace plvo {

// A message that ROS 1 serialised, and its type, like sensor_msgs/Image.
struct RosMessage {
  std::string type;
  std::vector<std::uint8_t> bytes;
};

// The fields that are used of sensor_msgs/Image, CameraInfo and Imu.
struct RosImage {
  std::int64_t stamp_ns = 0;
  std::uint32_t width = 0, height = 0;
  std::string encoding;
  bool big_endian = false;
  std::uint32_t step = 0;              // bytes from one row to the next
  const std::uint8_t* data = nullptr;  // memory of the caller
  std::size_t bytes = 0;
};
struct RosCameraInfo {
  std::uint32_t width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{};
};
struct RosImu {
  std::int64_t stamp_ns = 0;
  std::array<double, 3> angular_velocity{}, linear_acceleration{};  // rad/s, m/s²
  // The first numbers of their covariances: -1 marks a reading that is missing.
  double angular_velocity_variance = 0, linear_acceleration_variance = 0;
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
  std::uint32_t world = 0;    // rises where odom is another one: after a reset or a very long loss
  int points = 0, lines = 0;  // that agree with the motion
};
inline constexpr double kUnknownTwistVariance = 1e6;

class RosOdometry {
 public:
  PLVO_API explicit RosOdometry(const RosOdometrySettings& settings);
  PLVO_API ~RosOdometry();

  // Functions that return a text say what is wrong, or nothing.

  // A sensor_msgs/CameraInfo. The first one counts until reset(), which takes the latest one.
  PLVO_API std::string set_camera(const RosMessage& camera_info);
  PLVO_API std::string set_camera(const RosCameraInfo& camera_info);
  PLVO_API bool has_camera() const;
  // Where the camera, in optical axes, sits in the base. Call it before the first frame.
  PLVO_API std::string set_base_camera(const RosPose& T_base_camera);
  // Rotation from the axes of the IMU to those of the camera, x y z w.
  PLVO_API std::string set_imu_axes(const std::array<double, 4>& q_camera_imu);
  // A sensor_msgs/Imu. Its stamp is stored.
  PLVO_API std::string add_imu(const RosMessage& imu, std::int64_t& stamp_ns);
  PLVO_API std::string add_imu(const RosImu& imu);

  // Images that belong together, sensor_msgs/Image or sensor_msgs/CompressedImage.
  PLVO_API RosEstimate track(const RosMessage& colour, const RosMessage& depth);
  PLVO_API RosEstimate track(const RosImage& colour, const RosImage& depth);

  // The next frame is the first one.
  PLVO_API void reset();
  // The pose of the base at the last frame that has one, with its covariance; before the first frame, at
  // that.
  PLVO_API std::string set_pose(const RosPose& T_odom_base, const RosCovariance& covariance);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace plvo
