// SPDX-License-Identifier: Apache-2.0
// What of a ROS 1 bag is read, by the names of its topics.
#pragma once

#include <string>

namespace plvo {

// An empty name leaves the choice to plvo. Images: TUM's (/camera/rgb/image_color, /camera/depth/image) where
// the bag has it, else the one topic whose encoding is of that kind; camera_info beside colour; gyro and
// accelerometer: the one topic of sensor_msgs/Imu that has such readings.
struct BagTopicNames {
  std::string colour, depth, camera_info, gyro, accelerometer;
};

}  // namespace plvo
