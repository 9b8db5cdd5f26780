// SPDX-License-Identifier: Apache-2.0
// The topics of a recording of messages that are read, by their names.
#pragma once

#include <string>

namespace plvo {

// An empty name leaves the choice to plvo (topic_choice.hpp).
struct BagTopicNames {
  std::string colour, depth, camera_info, gyro, accelerometer;
  std::string truth = {};
};

}  // namespace plvo
