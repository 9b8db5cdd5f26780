// SPDX-License-Identifier: Apache-2.0
// Wheel odometry from a recording of messages: the twist of nav_msgs/Odometry.
#pragma once

#include <string>

#include "plvo/replay/wheel_files.hpp"
#include "plvo/rosbag/containers/message_file.hpp"

namespace plvo {

// Samples are sorted by the stamps in their headers; of equal stamps the first is kept, damaged messages and
// numbers that are not finite are left out and counted. Standard deviations are those of the covariances, if
// every one of vx, vy and wz is positive. Returns kNotFound, listing the topics with odometry, if that one
// has none; kDamaged if no message can be read; kInvalidArgument for more than kMostRows.
Status read_bag_wheels(MessageFile& bag, const std::string& topic, WheelRecording& recording);

}  // namespace plvo
