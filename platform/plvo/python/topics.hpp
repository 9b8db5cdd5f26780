// SPDX-License-Identifier: Apache-2.0
// Topics of a recording of ROS as Python names them.
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
  for (const auto& [given_key, value] : argument<py::dict>(given, "topics", "a dict")) {
    const std::string key = text(given_key, "topics");
    std::string* name = nullptr;
    for (const auto& [word, place] : known)
      if (key == word) name = place;
    if (name == nullptr)
      throw py::value_error("topics: '" + key +
                            "' is not one of colour, depth, camera_info, gyro, accelerometer");
    *name = text(value, "topics['" + key + "']");
  }
  return names;
}

}  // namespace plvo::python
