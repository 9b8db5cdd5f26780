// SPDX-License-Identifier: Apache-2.0
// Reads sensor_msgs/Imu of a recording as the samples of a gyro and an accelerometer. One topic may have
// both, or each has its own. Not every driver marks a missing sensor: readings that are zero throughout are
// ignored.
#pragma once

#include "plvo/replay/imu_files.hpp"
#include "plvo/rosbag/bag_topics.hpp"
#include "plvo/rosbag/containers/message_file.hpp"

namespace plvo {

// Sorts the samples by stamp. Leaves out and counts damaged messages, readings that are not finite, and all
// but the first of readings with the same stamp. Returns kNotFound if there are no readings, or none on the
// named topic, and kInvalidArgument if there are several candidates; both messages list the topics. Also
// returns kInvalidArgument if all readings have one stamp, or there are more than kMostReadings; kIo.
Status read_bag_imu(MessageFile& bag, const BagTopicNames& names, ImuRecording& recording);

}  // namespace plvo
