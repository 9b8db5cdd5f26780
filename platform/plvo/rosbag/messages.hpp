// SPDX-License-Identifier: Apache-2.0
// Parses sensor_msgs/Image, CameraInfo and Imu of ROS 1, and converts the pixels of an image to plvo's
// formats: colour as RGB, depth in whole units (REP 118: 16UC1 is millimetres, 32FC1 metres; mono16 is 16UC1,
// as librealsense writes it). 8UC3 does not define its channels: they are taken as BGR, as in OpenCV.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "plvo/base/status.hpp"
#include "plvo/math/types.hpp"
#include "plvo/replay/calibration/calibration.hpp"

namespace plvo {

inline constexpr const char* kImageType = "sensor_msgs/Image";
inline constexpr const char* kCameraInfoType = "sensor_msgs/CameraInfo";
inline constexpr const char* kImuType = "sensor_msgs/Imu";

// Points into the bytes that it was parsed from.
struct ImageMessage {
  std::int64_t stamp_ns = 0;
  int width = 0, height = 0;
  std::string_view encoding;
  bool big_endian = false;
  std::size_t step = 0;  // bytes from one row to the next
  std::span<const unsigned char> data;
};

// Returns kDamaged if the bytes end early, or there are fewer pixels than the size requires; kInvalidArgument
// for an image that exceeds the limit of recordings (plvo/replay/images/image_decoder.hpp).
Status parse_image(std::span<const unsigned char> bytes, ImageMessage& image);

// Parses camera and size. Returns kDamaged if the bytes end early, kUnsupported for an unknown lens model,
// kInvalidArgument for impossible numbers (the K of an uncalibrated camera is zero).
Status parse_camera_info(std::span<const unsigned char> bytes, Calibration& calibration);

// A reading is empty if the message marks it as missing, by a covariance that begins with -1.
struct ImuMessage {
  std::int64_t stamp_ns = 0;
  std::optional<Vector3> rate, force;  // rad/s, m/s²
};

// Returns kDamaged if the bytes end early.
Status parse_imu(std::span<const unsigned char> bytes, ImuMessage& imu);

inline constexpr const char* kColourEncodings = "rgb8, bgr8, rgba8, bgra8, 8UC3 or mono8";
inline constexpr const char* kDepthEncodings = "16UC1, mono16 or 32FC1";
bool is_colour_encoding(std::string_view encoding);
bool is_depth_encoding(std::string_view encoding);

// Factor from metres to whole units, as in TUM's own PNGs of the same recordings.
inline constexpr double kFloatDepthUnitsPerMetre = kTumDepthUnitsPerMetre;

// rgb: width·height·3. Returns kUnsupported, naming the encoding, if it is not of colour.
Status colour_pixels(const ImageMessage& image, std::span<std::uint8_t> rgb);
// depth: width·height. Values of 32FC1 that are not a number, not positive or beyond 16 bits become 0, no
// depth.
Status depth_pixels(const ImageMessage& image, std::span<std::uint16_t> depth);

}  // namespace plvo
