// SPDX-License-Identifier: Apache-2.0
// Topics of a ROS 1 bag as Python names them.
#pragma once

#include <string>
#include <utility>

#include "plvo/python/bindings.hpp"
#include "plvo/rosbag/bag_topics.hpp"

namespace plvo::python {

// None, or a dictionary with the names of topics.
inline BagTopicNames bag_topics(const py::object& given) {
  BagTopicNames names;
  if (given.is_none()) return names;
  const std::pair<const char*, std::string*> known[] = {{"colour", &names.colour},
                                                        {"depth", &names.depth},
                                                        {"camera_info", &names.camera_info},
                                                        {"gyro", &names.gyro},
                                                        {"accelerometer", &names.accelerometer}};
  for (const auto& [key, value] : given.cast<py::dict>()) {
    std::string* name = nullptr;
    for (const auto& [word, place] : known)
      if (key.cast<std::string>() == word) name = place;
    if (name == nullptr)
      throw py::value_error("topics: '" + key.cast<std::string>() +
                            "' is none of colour, depth, camera_info, gyro, accelerometer");
    *name = value.cast<std::string>();
  }
  return names;
}

}  // namespace plvo::python
