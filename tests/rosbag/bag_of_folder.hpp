// SPDX-License-Identifier: Apache-2.0
// Turns a recorded folder into the messages that a driver would have published, and into a bag of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "bag_writer.hpp"
#include "library_writer.hpp"
#include "plvo/replay/imu_files.hpp"
#include "plvo/replay/recorded_camera.hpp"

namespace plvo::test {

inline constexpr const char* kTumColour = "/camera/rgb/image_color";
inline constexpr const char* kTumDepth = "/camera/depth/image";
inline constexpr const char* kTumInfo = "/camera/rgb/camera_info";
inline constexpr const char* kNotRead = "/tf";

// Four messages per frame: camera_info, depth (32FC1 if `metres`, else 16UC1 in the folder's units), colour,
// and one of a type that plvo does not read.
inline std::vector<RecordedMessage> published(const std::filesystem::path& folder, bool metres) {
  Calibration calibration;
  EXPECT_TRUE(read_calibration(folder / "calibration.txt", calibration).ok());
  RecordedCamera camera;
  EXPECT_TRUE(camera.open(folder, calibration).ok());
  std::vector<RecordedMessage> messages;
  RgbdFrame frame;
  while (camera.next(frame).ok()) {
    const std::int64_t late = frame.stamp_ns + 40'000'000;
    const Distortion& lens = camera.model().distortion;
    messages.push_back({kTumInfo, "sensor_msgs/CameraInfo",
                        camera_info_message(frame.stamp_ns, camera.model(), "plumb_bob",
                                            {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3}),
                        late});
    messages.push_back({kTumDepth, "sensor_msgs/Image", depth_message(frame, metres), late});
    messages.push_back({kTumColour, "sensor_msgs/Image", colour_message(frame), late});
    messages.push_back({kNotRead, "tf2_msgs/TFMessage", "not looked at", late});
  }
  EXPECT_EQ(messages.size(), 4 * camera.frame_count());
  return messages;
}

// Messages of the folder's gyro and accelerometer. kBoth: both in one message, which requires samples at the
// same times. kAcceleration: as from a Kinect, with the gyro declared missing. kGyroAlone and
// kAccelerationAlone: as from a RealSense, with zeros for the missing sensor.
enum class ImuContent { kBoth, kAcceleration, kGyroAlone, kAccelerationAlone };
inline std::vector<RecordedMessage> published_imu(const std::filesystem::path& folder,
                                                  const std::string& topic, ImuContent content) {
  ImuRecording recorded;
  EXPECT_TRUE(read_imu_files(folder, recorded).ok());
  EXPECT_EQ(recorded.gyro.size(), recorded.accelerometer.size());
  std::vector<RecordedMessage> messages;
  for (std::size_t i = 0; i < recorded.accelerometer.size(); ++i) {
    const ImuSample &rate = recorded.gyro[i], &force = recorded.accelerometer[i];
    EXPECT_EQ(rate.stamp_ns, force.stamp_ns);
    const bool has_rate = content == ImuContent::kBoth || content == ImuContent::kGyroAlone;
    const bool has_force = content != ImuContent::kGyroAlone;
    const std::string data =
        imu_message(force.stamp_ns, has_rate ? rate.value : Vector3(0, 0, 0),
                    content != ImuContent::kAcceleration, has_force ? force.value : Vector3(0, 0, 0), true);
    messages.push_back({topic, "sensor_msgs/Imu", data, force.stamp_ns + 1'000'000});
  }
  return messages;
}

// Each message of the type that plvo does not read ends a chunk.
inline std::string bag_of(const std::vector<RecordedMessage>& messages, const std::string& compression) {
  BagWriter writer;
  std::vector<std::string> topics;
  for (const RecordedMessage& message : messages) {
    const auto known = std::find(topics.begin(), topics.end(), message.topic);
    const auto number = static_cast<std::uint32_t>(known - topics.begin());
    if (known == topics.end()) {
      topics.push_back(message.topic);
      writer.connection(number, message.topic, message.type);
    }
    writer.message(number, message.received_ns, message.data);
    if (message.topic == kNotRead) writer.end_chunk(compression);
  }
  return writer.file();
}

}  // namespace plvo::test
