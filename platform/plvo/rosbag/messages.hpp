// SPDX-License-Identifier: Apache-2.0
// sensor_msgs/Image, CameraInfo and Imu of ROS 1, from the bytes of a message, and an image's pixels as plvo
// has them: colour as RGB, depth in whole units (REP 118: 16UC1 is millimetres, 32FC1 metres; mono16 is
// 16UC1, as librealsense writes it). 8UC3 says nothing of its channels: they are taken for BGR, as OpenCV has
// them.
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

// Looks into the bytes that it was parsed from.
struct ImageMessage {
  std::int64_t stamp_ns = 0;
  int width = 0, height = 0;
  std::string_view encoding;
  bool big_endian = false;
  std::size_t step = 0;  // bytes from one row to the next
  std::span<const unsigned char> data;
};

// kDamaged where the bytes end early, or there are fewer pixels than the size says; kInvalidArgument for an
// image larger than a recording's may be (plvo/replay/images/image_decoder.hpp).
Status parse_image(std::span<const unsigned char> bytes, ImageMessage& image);

// Camera and size. kDamaged where the bytes end early, kUnsupported for a lens that plvo does not know,
// kInvalidArgument for numbers that cannot be (a camera that is not calibrated has a K of zeros).
Status parse_camera_info(std::span<const unsigned char> bytes, Calibration& calibration);

// Nothing in place of what the sensor says it does not have, by a covariance that begins with -1.
struct ImuMessage {
  std::int64_t stamp_ns = 0;
  std::optional<Vector3> rate, force;  // rad/s, m/s²
};

// kDamaged where the bytes end early.
Status parse_imu(std::span<const unsigned char> bytes, ImuMessage& imu);

inline constexpr const char* kColourEncodings = "rgb8, bgr8, rgba8, bgra8, 8UC3 or mono8";
inline constexpr const char* kDepthEncodings = "16UC1, mono16 or 32FC1";
bool is_colour_encoding(std::string_view encoding);
bool is_depth_encoding(std::string_view encoding);

// What metres are multiplied by to become whole units: as TUM's own PNGs of the same recordings have it.
inline constexpr double kFloatDepthUnitsPerMetre = kTumDepthUnitsPerMetre;

// rgb: width·height·3. kUnsupported, naming the encoding, for one that is not of colour.
Status colour_pixels(const ImageMessage& image, std::span<std::uint8_t> rgb);
// depth: width·height. Of 32FC1, what is no number, not positive or beyond 16 bits is no depth.
Status depth_pixels(const ImageMessage& image, std::span<std::uint16_t> depth);

}  // namespace plvo
