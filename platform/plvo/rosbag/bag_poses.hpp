// SPDX-License-Identifier: Apache-2.0
// True poses from a recording of messages: nav_msgs/Odometry or geometry_msgs/PoseStamped.
#pragma once

#include <string>

#include "plvo/host/files/trajectory_reader.hpp"
#include "plvo/rosbag/containers/message_file.hpp"

namespace plvo {

// Takes the named topic, or else the only one of those types. Poses are sorted by the stamps in their
// headers; of equal stamps the first is kept. Returns kNotFound if there is none, listing those that there
// are if a name was given; kInvalidArgument for several; kDamaged if no message can be read.
Status read_bag_poses(MessageFile& bag, const std::string& wanted, Trajectory& trajectory);

// Whether read_bag_poses would find a topic; its name.
Status choose_bag_poses(const MessageFile& bag, const std::string& wanted, std::size_t& topic);

}  // namespace plvo
