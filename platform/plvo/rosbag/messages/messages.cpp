// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/messages/messages.hpp"

#include <fmt/core.h>

#include <vector>

#include "plvo/camera/camera_info.hpp"
#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/rosbag/messages/image_conversion.hpp"

namespace plvo {
namespace {

Status message_ends_early() { return {StatusCode::kDamaged, "the message ends early"}; }

struct MessageHeader {
  std::int64_t stamp_ns = 0;
  std::string_view frame;
};

std::string_view without_slash(std::string_view frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

MessageHeader take_header(WireFormat wire, WireReader& reader) {
  if (wire == WireFormat::kRos1) reader.u32();  // a counter
  MessageHeader header;
  header.stamp_ns = reader.time_ns();
  header.frame = without_slash(reader.text());
  return header;
}

ImageMessage take_image_header(WireFormat wire, WireReader& reader) {
  const MessageHeader header = take_header(wire, reader);
  ImageMessage image;
  image.stamp_ns = header.stamp_ns;
  image.frame = header.frame;
  return image;
}

// Returns false for numbers that are not a rotation and a translation.
bool take_transform(WireReader& reader, Se3& transform) {
  const double x = reader.f64(), y = reader.f64(), z = reader.f64();
  Quaternion q;
  q.x = reader.f64();
  q.y = reader.f64();
  q.z = reader.f64();
  q.w = reader.f64();
  transform = {to_rotation(q), {x, y, z}};
  const double norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  return norm > 0.9 && norm < 1.1 && transform.is_finite();
}

Status no_pose() { return {StatusCode::kDamaged, "the numbers are not a position and a unit quaternion"}; }

}  // namespace

std::int64_t stamp_of_message(WireFormat wire, std::span<const unsigned char> start) {
  WireReader reader(wire, start);
  if (wire == WireFormat::kRos1) reader.u32();
  return reader.time_ns();
}

Status set_size(std::uint32_t width, std::uint32_t height, ImageMessage& image) {
  constexpr std::uint32_t kMost = kMaxImageSide;
  if (width < 1 || height < 1 || width > kMost || height > kMost)
    return {StatusCode::kInvalidArgument,
            fmt::format("an image of {}x{}; at most {}x{} are read", width, height, kMost, kMost)};
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  const std::uint64_t row = std::uint64_t{width} * bytes_of_pixel(image.encoding);
  if (image.step < row || image.data.size() < std::uint64_t{image.step} * (height - 1) + row)
    return {StatusCode::kDamaged, fmt::format("an image of {}x{} has {} bytes in rows of {}: too few", width,
                                              height, image.data.size(), image.step)};
  return {};
}

Status parse_image(WireFormat wire, std::span<const unsigned char> bytes, ImageMessage& image) {
  WireReader reader(wire, bytes);
  image = take_image_header(wire, reader);
  const std::uint32_t height = reader.u32(), width = reader.u32();
  image.encoding = reader.text();
  image.big_endian = reader.u8() != 0;
  image.step = reader.u32();
  image.data = reader.take(reader.u32());
  return reader.ok() ? set_size(width, height, image) : message_ends_early();
}

Status parse_compressed_image(WireFormat wire, std::span<const unsigned char> bytes, ImageMessage& image) {
  WireReader reader(wire, bytes);
  image = take_image_header(wire, reader);
  // Such as "rgb8; jpeg compressed bgr8", "16UC1; compressedDepth png" or "jpeg".
  const std::string_view format = reader.text();
  image.data = reader.take(reader.u32());
  if (!reader.ok()) return message_ends_early();
  image.content = ImageMessage::Content::kFile;
  if (const std::size_t end = format.find(';'); end != std::string_view::npos)
    image.encoding = format.substr(0, end);
  if (format.find("compressedDepth") == std::string_view::npos) return {};
  if (format.find("rvl") != std::string_view::npos)
    return {StatusCode::kUnsupported, "compressedDepth of the format rvl is not read; png is"};
  image.content = ImageMessage::Content::kDepthFile;
  WireReader config(image.data);
  config.u32();  // the number of the format, which the encoding says, too
  image.depth_a = config.f32();
  image.depth_b = config.f32();
  image.data = config.take(config.left());
  return config.ok() ? Status() : message_ends_early();
}

Status calibration_of(const CameraInfoMessage& info, Calibration& calibration) {
  constexpr std::uint32_t kMost = kMaxImageSide;
  Calibration found;
  if (info.width >= 1 && info.height >= 1 && info.width <= kMost && info.height <= kMost) {
    found.camera.width = static_cast<int>(info.width);
    found.camera.height = static_cast<int>(info.height);
    found.has_size = true;
  }
  const auto K = info.K;
  found.camera.pinhole = {K[0], K[4], K[2], K[5]};
  if (!(K[0] > 0 && K[4] > 0))
    return {StatusCode::kInvalidArgument, "K holds no focal length: the camera was not calibrated"};
  if (Status status = distortion_of(info.distortion_model, info.D, found.camera.distortion); !status.ok())
    return status;
  calibration = found;
  return {};
}

Status parse_camera_info(WireFormat wire, std::span<const unsigned char> bytes, Calibration& calibration) {
  WireReader reader(wire, bytes);
  take_header(wire, reader);
  const std::uint32_t height = reader.u32(), width = reader.u32();
  const std::string_view model = reader.text();
  const std::uint32_t count = reader.u32();
  if (count > reader.left() / sizeof(double)) return message_ends_early();
  std::vector<double> coefficients(count);
  for (double& coefficient : coefficients) coefficient = reader.f64();
  double K[9];
  for (double& entry : K) entry = reader.f64();
  return reader.ok() ? calibration_of({width, height, model, coefficients, K}, calibration)
                     : message_ends_early();
}

Status parse_imu(WireFormat wire, std::span<const unsigned char> bytes, ImuMessage& imu) {
  WireReader reader(wire, bytes);
  ImuMessage found;
  found.stamp_ns = take_header(wire, reader).stamp_ns;
  constexpr std::size_t kOrientation = 4 + 9, kRestOfCovariance = 8;
  reader.skip_f64(kOrientation);
  for (std::optional<Vector3>* reading : {&found.rate, &found.force}) {
    const double x = reader.f64(), y = reader.f64(), z = reader.f64();
    if (reader.f64() != -1) *reading = Vector3(x, y, z);
    reader.skip_f64(kRestOfCovariance);
  }
  if (!reader.ok()) return message_ends_early();
  imu = found;
  return {};
}

Status parse_pose(std::string_view type, WireFormat wire, std::span<const unsigned char> bytes,
                  PoseMessage& pose) {
  WireReader reader(wire, bytes);
  PoseMessage found;
  found.stamp_ns = take_header(wire, reader).stamp_ns;
  if (type == kOdometryType) reader.text();  // the frame of the robot
  const bool good = take_transform(reader, found.pose);
  if (!reader.ok()) return message_ends_early();
  if (!good) return no_pose();
  pose = found;
  return {};
}

Status parse_twist(WireFormat wire, std::span<const unsigned char> bytes, TwistMessage& twist) {
  WireReader reader(wire, bytes);
  TwistMessage found;
  found.stamp_ns = take_header(wire, reader).stamp_ns;
  reader.text();  // the frame of the robot
  constexpr std::size_t kPose = 7, kCovariance = 36;
  reader.skip_f64(kPose + kCovariance);
  for (int i = 0; i < 6; ++i) found.twist[i] = reader.f64();
  for (int i = 0; i < 6; ++i) {
    found.variance[i] = reader.f64();
    constexpr std::size_t kToNextOnDiagonal = 6;
    if (i < 5) reader.skip_f64(kToNextOnDiagonal);
  }
  if (!reader.ok()) return message_ends_early();
  twist = found;
  return {};
}

Status parse_transform(WireFormat wire, std::span<const unsigned char> bytes, Se3& transform) {
  WireReader reader(wire, bytes);
  Se3 found;
  const bool good = take_transform(reader, found);
  if (!reader.ok()) return message_ends_early();
  if (!good) return no_pose();
  transform = found;
  return {};
}

Status parse_transforms(WireFormat wire, std::span<const unsigned char> bytes,
                        std::vector<FrameTransform>& transforms) {
  WireReader reader(wire, bytes);
  std::vector<FrameTransform> found;
  for (std::uint32_t left = reader.u32(); left > 0 && reader.ok(); --left) {
    FrameTransform transform;
    transform.parent = take_header(wire, reader).frame;
    transform.child = without_slash(reader.text());
    if (take_transform(reader, transform.T_parent_child)) found.push_back(transform);
  }
  if (!reader.ok()) return message_ends_early();
  transforms = std::move(found);
  return {};
}

Status parse_float(WireFormat wire, std::span<const unsigned char> bytes, float& value) {
  WireReader reader(wire, bytes);
  const float found = reader.f32();
  if (!reader.ok()) return message_ends_early();
  value = found;
  return {};
}

}  // namespace plvo
