// SPDX-License-Identifier: Apache-2.0
// Reads calibrations in YAML: plvo's keys; ROS's camera_info as the calibration tools write it (image_width,
// camera_matrix: {data: …}, distortion_model, distortion_coefficients: {data: …}) and as a printed message
// shows it (width, K or k, D or d); and the formats of other programs (other_programs.cpp). JSON is YAML.
#include <string>
#include <vector>

#include "plvo/camera/camera_info.hpp"
#include "plvo/replay/calibration/calibration_keys.hpp"
#include "plvo/replay/calibration/yaml_nodes.hpp"

namespace plvo::calibration_form {
namespace {

namespace fs = std::filesystem;

YAML::Node camera_matrix(const YAML::Node& root) { return first_of(root, {"camera_matrix", "K", "k"}); }

Status from_camera_info(const fs::path& path, const YAML::Node& root, Collector& collector) {
  const std::vector<double> K = numbers(camera_matrix(root));
  if (K.size() != 9) return damaged(path, "camera_matrix must have 9 numbers (fx 0 cx 0 fy cy 0 0 1)");
  const std::vector<double> D = numbers(first_of(root, {"distortion_coefficients", "D", "d"}));
  Distortion lens;
  const Status known = distortion_of(text_of(root[std::string(kLensModelKey)]), D, lens);
  if (!known.ok()) return of_file(path, known);
  collector.set_lens({K[0], K[4], K[2], K[5]}, lens);
  return set_size(collector, first_of(root, {"image_width", "width"}),
                  first_of(root, {"image_height", "height"}));
}

// Properties that other formats lack may be added with plvo's keys.
Status set_sensor_keys(const YAML::Node& root, Collector& collector) {
  for (const Key& key : keys()) {
    if (key.kind == KeyKind::kLens || key.kind == KeyKind::kSize) continue;
    const std::string name(key.name);
    if (const YAML::Node value = root[name]; value)
      if (Status status = set(collector, name, value); !status.ok()) return status;
  }
  return {};
}

Status from_keys(const YAML::Node& root, Collector& collector) {
  for (const auto& entry : root)
    if (Status status = set(collector, entry.first.as<std::string>(), entry.second); !status.ok())
      return status;
  return {};
}

}  // namespace

Status parse_yaml(const fs::path& path, const std::string& content, Calibration& calibration) {
  try {
    const YAML::Node root = YAML::Load(content);
    if (!root.IsMap())
      return damaged(path, "has no keys; expected fx, fy, cx, cy …, or a camera_info with camera_matrix");
    Collector collector(path);
    const YamlReader read = camera_matrix(root) ? &from_camera_info : reader_of_other_programs(root);
    Status status = read != nullptr ? read(path, root, collector) : from_keys(root, collector);
    if (status.ok() && read != nullptr) status = set_sensor_keys(root, collector);
    return status.ok() ? collector.finish(calibration) : status;
  } catch (const YAML::Exception& error) {
    return damaged(path, error.what());
  }
}

}  // namespace plvo::calibration_form
