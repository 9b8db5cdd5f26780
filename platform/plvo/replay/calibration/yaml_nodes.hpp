// SPDX-License-Identifier: Apache-2.0
// Functions that the readers of the YAML formats share. They throw YAML::Exception for a value of the wrong
// kind; parse_yaml catches it. Internal to this folder.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/replay/calibration/calibration_keys.hpp"

namespace plvo::calibration_form {

// Reads one format from its root into the collector.
using YamlReader = Status (*)(const std::filesystem::path& path, const YAML::Node& root,
                              Collector& collector);

// Selects the reader for Kalibr and EuRoC, ORB-SLAM or Open3D by the keys of the root; nullptr if none fits.
YamlReader reader_of_other_programs(const YAML::Node& root);

// The value of the first existing key; an undefined node if there is none.
inline YAML::Node first_of(const YAML::Node& map, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (map[key]) return map[key];
  return YAML::Node(YAML::NodeType::Undefined);
}

inline std::string text_of(const YAML::Node& node) { return node ? node.as<std::string>() : std::string(); }

// Reads a list of numbers, also one under the key `data`; empty without a node.
inline std::vector<double> numbers(const YAML::Node& node) {
  if (!node) return {};
  const YAML::Node data = node.IsMap() ? node["data"] : node;
  return data ? data.as<std::vector<double>>() : std::vector<double>();
}

inline Status set(Collector& collector, std::string_view key, const YAML::Node& value) {
  return collector.set(key, value.IsScalar() ? value.Scalar() : std::string());
}

inline Status set_size(Collector& collector, const YAML::Node& width, const YAML::Node& height) {
  const Status status = width ? set(collector, "width", width) : Status();
  return status.ok() && height ? set(collector, "height", height) : status;
}

// Turns an error of the lens into one of the file.
inline Status of_file(const std::filesystem::path& path, const Status& lens) {
  const bool unsupported = lens.code() == StatusCode::kUnsupported;
  return Status(unsupported ? StatusCode::kUnsupported : StatusCode::kDamaged, path.string())
      .append(": ")
      .append(lens.message());
}

}  // namespace plvo::calibration_form
