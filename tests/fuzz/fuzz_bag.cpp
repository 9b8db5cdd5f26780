// SPDX-License-Identifier: Apache-2.0
// Any bytes as a recording of ROS (bag, MCAP file or database, by their first bytes): each message is read
// and parsed as every kind of message. Also any bytes as a message of ROS 1 and of ROS 2.
#include <memory>
#include <string_view>
#include <vector>

#include "plvo/rosbag/containers/open_container.hpp"
#include "plvo/rosbag/messages/image_conversion.hpp"
#include "plvo/rosbag/messages/messages.hpp"
#include "scratch_file.hpp"

namespace {

void require_words(const plvo::Status& status) {
  plvo::fuzz::require(status.ok() || !std::string_view(status.message()).empty());
}

void check_message(plvo::WireFormat wire, std::span<const unsigned char> bytes) {
  using namespace plvo;
  ImageConversion conversion;
  for (const char* type : {kImageType, kCompressedImageType}) {
    ImageMessage image;
    const Status parsed = conversion.parse(type, wire, bytes, image);
    require_words(parsed);
    if (!parsed.ok() || image.width * image.height > 1 << 16) continue;
    const auto pixels = static_cast<std::size_t>(image.width * image.height);
    std::vector<std::uint8_t> rgb(3 * pixels);
    std::vector<std::uint16_t> depth(pixels);
    require_words(conversion.colour(image, rgb));
    require_words(conversion.depth(image, depth));
  }
  ImuMessage imu;
  require_words(parse_imu(wire, bytes, imu));
  Calibration calibration;
  require_words(parse_camera_info(wire, bytes, calibration));
  for (const char* type : {kOdometryType, kPoseStampedType}) {
    PoseMessage pose;
    require_words(parse_pose(type, wire, bytes, pose));
    fuzz::require(pose.pose.is_finite());
  }
  Se3 transform;
  require_words(parse_transform(wire, bytes, transform));
  fuzz::require(transform.is_finite());
  std::vector<FrameTransform> transforms;
  require_words(parse_transforms(wire, bytes, transforms));
  float number = 0;
  require_words(parse_float(wire, bytes, number));
}

void check_recording(plvo::MessageFile& bag) {
  using namespace plvo;
  std::vector<unsigned char> bytes;
  std::size_t readings = 0;
  for (std::size_t topic = 0; topic < bag.topics().size(); ++topic) {
    readings += bag.topics()[topic].type == kImuType ? bag.topics()[topic].messages : 0;
    for (const BagMessage& message : bag.messages(topic))
      if (bag.read(message, bytes).ok()) check_message(message.wire, bytes);
  }
  const Status visited = bag.visit(kImuType, [&](std::size_t topic, std::span<const unsigned char> reading) {
    fuzz::require(topic < bag.topics().size());
    check_message(bag.topics()[topic].wire, reading);
    --readings;
    return Status();
  });
  fuzz::require(visited.ok() && readings == 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plvo;
  check_message(WireFormat::kRos1, {data, size});
  check_message(WireFormat::kCdr, {data, size});
  std::unique_ptr<MessageFile> bag;
  const Status status = open_messages(fuzz::write_scratch("a.bag", data, size), bag);
  require_words(status);
  if (status.ok()) check_recording(*bag);
  return 0;
}
