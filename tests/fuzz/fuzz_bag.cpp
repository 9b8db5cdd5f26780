// SPDX-License-Identifier: Apache-2.0
// Any bytes as a ROS bag: each message is read and parsed as an image, as a camera_info and as readings of an
// IMU. Also any bytes as a message.
#include <string_view>
#include <vector>

#include "plvo/rosbag/bag_file.hpp"
#include "plvo/rosbag/messages.hpp"
#include "scratch_file.hpp"

namespace {

void check_message(std::span<const unsigned char> bytes) {
  using namespace plvo;
  ImageMessage image;
  const Status parsed = parse_image(bytes, image);
  fuzz::require(parsed.ok() || !std::string_view(parsed.message()).empty());
  if (parsed.ok() && image.width * image.height <= 1 << 16) {
    const auto pixels = static_cast<std::size_t>(image.width * image.height);
    std::vector<std::uint8_t> rgb(3 * pixels);
    std::vector<std::uint16_t> depth(pixels);
    (void)colour_pixels(image, rgb);
    (void)depth_pixels(image, depth);
  }
  ImuMessage imu;
  const Status readings = parse_imu(bytes, imu);
  fuzz::require(readings.ok() || !std::string_view(readings.message()).empty());
  Calibration calibration;
  const Status info = parse_camera_info(bytes, calibration);
  fuzz::require(info.ok() || !std::string_view(info.message()).empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plvo;
  check_message({data, size});
  BagFile bag;
  const Status status = bag.open(fuzz::write_scratch("a.bag", data, size));
  if (!status.ok()) {
    fuzz::require(!std::string_view(status.message()).empty());
    return 0;
  }
  std::vector<unsigned char> bytes;
  std::size_t readings = 0;
  for (std::size_t topic = 0; topic < bag.topics().size(); ++topic) {
    readings += bag.topics()[topic].type == kImuType ? bag.topics()[topic].messages : 0;
    for (const BagMessage& message : bag.messages(topic)) {
      fuzz::require(bag.read(message, bytes).ok() && bytes.size() == message.bytes);
      check_message(bytes);
    }
  }
  const Status visited = bag.visit(kImuType, [&](std::size_t topic, std::span<const unsigned char> reading) {
    fuzz::require(topic < bag.topics().size());
    check_message(reading);
    --readings;
    return Status();
  });
  fuzz::require(visited.ok() && readings == 0);
  return 0;
}
