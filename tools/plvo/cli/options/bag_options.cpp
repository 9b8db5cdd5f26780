// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/options/bag_options.hpp"

namespace plvo::cli {
namespace {

OptionGroup::Reader read_topic(std::string& topic) {
  return [&topic](const std::string& text) -> std::string {
    if (text.empty()) return expected("the name of a topic", text);
    topic = text;
    return {};
  };
}

}  // namespace

void add_bag_options(CLI::App& command, BagTopicNames& topics, BagImu imu) {
  OptionGroup bag(command, kBagGroup);
  bag.add("--colour-topic", "TOPIC",
          "With images of colour (default /camera/rgb/image_color, or the only one)",
          read_topic(topics.colour));
  bag.add("--depth-topic", "TOPIC",
          "With images of depth (default /camera/depth/image, or the only one in colour's view)",
          read_topic(topics.depth));
  bag.add("--info-topic", "TOPIC", "Of sensor_msgs/CameraInfo (default camera_info beside colour)",
          read_topic(topics.camera_info));
  if (imu == BagImu::kPassedOver) return;
  bag.add("--gyro-topic", "TOPIC", "Of sensor_msgs/Imu, for --imu (default the only one with turn rates)",
          read_topic(topics.gyro));
  bag.add("--accelerometer-topic", "TOPIC",
          "Of sensor_msgs/Imu, for --imu (default the only one with accelerations)",
          read_topic(topics.accelerometer));
  bag.add("--truth-topic", "TOPIC",
          "Of nav_msgs/Odometry or geometry_msgs/PoseStamped, the true poses (default the only one)",
          read_topic(topics.truth));
}

void refuse_bag_options(const CLI::App& command) {
  refuse_group(command, kBagGroup, "is for a ROS bag (.bag, .mcap, .db3, a folder of rosbag2)");
}

}  // namespace plvo::cli
