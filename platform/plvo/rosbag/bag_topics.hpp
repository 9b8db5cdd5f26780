// SPDX-License-Identifier: Apache-2.0
// The topics of a ROS 1 bag that are read, by their names.
#pragma once

#include <string>

namespace plvo {

// An empty name leaves the choice to plvo. Images: TUM's topics (/camera/rgb/image_color,
// /camera/depth/image) if the bag has them, else the only topic with a fitting encoding. camera_info: the one
// beside colour. Gyro and accelerometer: the only topic of sensor_msgs/Imu with such readings.
struct BagTopicNames {
  std::string colour, depth, camera_info, gyro, accelerometer;
};

}  // namespace plvo
