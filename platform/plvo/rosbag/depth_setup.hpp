// SPDX-License-Identifier: Apache-2.0
// Where depth was not registered to colour: the camera of depth, as the recording states it.
//   librealsense  (the RealSense Viewer's recordings, topics /device_N/sensor_M/…): depth is never
//                 registered. camera_info of both streams; …/tf/G of each maps from a point of reference G
//                 to the stream; the option Depth Units is the unit of depth in metres.
//   ROS           the headers of depth name another frame than those of colour, and /tf_static (or /tf) leads
//                 from one to the other.
#pragma once

#include <optional>
#include <string>

#include "plvo/replay/images/depth_registration.hpp"
#include "plvo/rosbag/containers/message_file.hpp"
#include "plvo/rosbag/topic_choice.hpp"

namespace plvo {

struct DepthSetup {
  DepthCamera camera;                     // known if depth has to be registered
  std::optional<double> units_per_metre;  // of whole units, if the recording states it
  std::string remark;                     // what was found or is missing, in a sentence; may be empty
};

DepthSetup find_depth_setup(MessageFile& bag, const TopicChoice& topics);

}  // namespace plvo
