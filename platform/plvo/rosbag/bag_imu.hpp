// SPDX-License-Identifier: Apache-2.0
// sensor_msgs/Imu of a bag as what a gyro and an accelerometer read. One topic may have both, or each a topic
// of its own. Not every driver says what its sensor lacks: readings that are zero throughout are none.
#pragma once

#include "plvo/replay/imu_files.hpp"
#include "plvo/rosbag/bag_file.hpp"
#include "plvo/rosbag/bag_topics.hpp"

namespace plvo {

// By stamp; messages that are damaged, readings that are not finite, and of those with one stamp all but the
// first are left out and counted. kNotFound where there are no readings, or not on the topic that was named;
// kInvalidArgument where several topics could be meant; both say which there are;
// kInvalidArgument, too, where all readings have one stamp, or there are more than kMostReadings. kIo.
Status read_bag_imu(BagFile& bag, const BagTopicNames& names, ImuRecording& recording);

}  // namespace plvo
