// SPDX-License-Identifier: Apache-2.0
// Parses the messages that plvo uses, serialised by ROS 1 or ROS 2 (wire_reader.hpp): images, calibrations,
// readings of an IMU, poses and transforms. Types are named as in ROS 1.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/math/types.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/rosbag/messages/wire_reader.hpp"

namespace plvo {

inline constexpr const char* kImageType = "sensor_msgs/Image";
inline constexpr const char* kCompressedImageType = "sensor_msgs/CompressedImage";
inline constexpr const char* kCameraInfoType = "sensor_msgs/CameraInfo";
inline constexpr const char* kImuType = "sensor_msgs/Imu";
inline constexpr const char* kOdometryType = "nav_msgs/Odometry";
inline constexpr const char* kPoseStampedType = "geometry_msgs/PoseStamped";
inline constexpr const char* kTransformType = "geometry_msgs/Transform";
inline constexpr const char* kTransformsType = "tf2_msgs/TFMessage";
inline constexpr const char* kFloatType = "std_msgs/Float32";

inline bool is_image_type(std::string_view type) {
  return type == kImageType || type == kCompressedImageType;
}

// The first bytes of a message with a header contain its stamp.
inline constexpr std::size_t kBytesOfStamp = 12;
std::int64_t stamp_of_message(WireFormat wire, std::span<const unsigned char> start);

// Points into the bytes that it was parsed from.
struct ImageMessage {
  enum class Content : std::uint8_t {
    kPixels,  // rows of pixels
    kFile,    // sensor_msgs/CompressedImage: a PNG or a JPEG
    kDepthFile
  };  // the same of the transport compressedDepth: 12 bytes and a PNG

  std::int64_t stamp_ns = 0;
  std::string_view frame;  // frame_id, without the slash that ROS 1 may put in front
  Content content = Content::kPixels;
  int width = 0, height = 0;  // of a file: known after ImageConversion::parse
  std::string_view encoding;
  bool big_endian = false;
  std::size_t step = 0;  // bytes from one row to the next
  std::span<const unsigned char> data;
  // Depth of 32FC1 in a file is a / (value - b), or none if the value is 0.
  float depth_a = 0, depth_b = 0;
};

// Sets the size of pixels. Returns kDamaged if there are fewer than the size requires; kInvalidArgument for
// an image that exceeds the limit of recordings (plvo/replay/images/image_decoder.hpp).
Status set_size(std::uint32_t width, std::uint32_t height, ImageMessage& image);

// Returns kDamaged if the bytes end early, and the errors of set_size.
Status parse_image(WireFormat wire, std::span<const unsigned char> bytes, ImageMessage& image);
// Returns kDamaged if the bytes end early, kUnsupported for a compression that is not read.
Status parse_compressed_image(WireFormat wire, std::span<const unsigned char> bytes, ImageMessage& image);

struct CameraInfoMessage {
  std::uint32_t width = 0, height = 0;
  std::string_view distortion_model;
  std::span<const double> D;
  std::span<const double, 9> K;
};
// Returns kUnsupported for an unknown lens model, kInvalidArgument for impossible numbers (the K of an
// uncalibrated camera is zero).
Status calibration_of(const CameraInfoMessage& info, Calibration& calibration);

// Parses camera and size. Returns kDamaged if the bytes end early, and the errors of calibration_of.
Status parse_camera_info(WireFormat wire, std::span<const unsigned char> bytes, Calibration& calibration);

// A reading is empty if the message marks it as missing, by a covariance that begins with -1.
struct ImuMessage {
  std::int64_t stamp_ns = 0;
  std::optional<Vector3> rate, force;  // rad/s, m/s²
};

// Returns kDamaged if the bytes end early.
Status parse_imu(WireFormat wire, std::span<const unsigned char> bytes, ImuMessage& imu);

// A pose of nav_msgs/Odometry or geometry_msgs/PoseStamped.
struct PoseMessage {
  std::int64_t stamp_ns = 0;
  Se3 pose;
};

// Returns kDamaged if the bytes end early, or the numbers are not a pose.
Status parse_pose(std::string_view type, WireFormat wire, std::span<const unsigned char> bytes,
                  PoseMessage& pose);

// The twist of nav_msgs/Odometry: vx vy vz wx wy wz in the frame of the robot.
struct TwistMessage {
  std::int64_t stamp_ns = 0;
  Vector6 twist = Vector6::Zero(), variance = Vector6::Zero();  // m/s, rad/s, and their squares
};

// Returns kDamaged if the bytes end early.
Status parse_twist(WireFormat wire, std::span<const unsigned char> bytes, TwistMessage& twist);

// geometry_msgs/Transform. Returns kDamaged like parse_pose.
Status parse_transform(WireFormat wire, std::span<const unsigned char> bytes, Se3& transform);

// tf2_msgs/TFMessage. A transform maps coordinates in the child's frame to the parent's.
struct FrameTransform {
  std::string_view parent, child;
  Se3 T_parent_child;
};
Status parse_transforms(WireFormat wire, std::span<const unsigned char> bytes,
                        std::vector<FrameTransform>& transforms);

// std_msgs/Float32. Returns kDamaged if the bytes end early.
Status parse_float(WireFormat wire, std::span<const unsigned char> bytes, float& value);

}  // namespace plvo
