// SPDX-License-Identifier: Apache-2.0
// Calibrations in YAML: our keys, or ROS's camera_info as the calibration tools write it (image_width,
// camera_matrix: {data: …}, distortion_model, distortion_coefficients: {data: …}) and as a printed message
// shows it (width, K or k, D or d), with our keys of the sensor beside it.
#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "plvo/camera/camera_info.hpp"
#include "plvo/replay/calibration/calibration_keys.hpp"

namespace plvo::calibration_form {
namespace {

namespace fs = std::filesystem;

YAML::Node first_of(const YAML::Node& root, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (root[key]) return root[key];
  return YAML::Node(YAML::NodeType::Undefined);
}

std::vector<double> numbers(const YAML::Node& node) {
  if (!node) return {};
  const YAML::Node data = node.IsMap() ? node["data"] : node;
  return data ? data.as<std::vector<double>>() : std::vector<double>();
}

YAML::Node camera_matrix(const YAML::Node& root) { return first_of(root, {"camera_matrix", "K", "k"}); }

Status set(Collector& collector, const std::string& key, const YAML::Node& value) {
  return collector.set(key, value.IsScalar() ? value.Scalar() : std::string());
}

Status from_camera_info(const fs::path& path, const YAML::Node& root, Collector& collector) {
  const std::vector<double> K = numbers(camera_matrix(root));
  if (K.size() != 9) return damaged(path, "camera_matrix must have 9 numbers (fx 0 cx 0 fy cy 0 0 1)");
  const std::vector<double> D = numbers(first_of(root, {"distortion_coefficients", "D", "d"}));
  const YAML::Node model_node = root[std::string(kLensModelKey)];
  Distortion lens;
  if (Status status = distortion_of(model_node ? model_node.as<std::string>() : "", D, lens); !status.ok())
    return {status.code() == StatusCode::kUnsupported ? status.code() : StatusCode::kDamaged,
            fmt::format("{}: {}", path.string(), status.message())};
  collector.set_lens({K[0], K[4], K[2], K[5]}, lens);
  const YAML::Node width = first_of(root, {"image_width", "width"});
  const YAML::Node height = first_of(root, {"image_height", "height"});
  if (width && height) {
    if (Status status = set(collector, "width", width); !status.ok()) return status;
    if (Status status = set(collector, "height", height); !status.ok()) return status;
  }
  for (const Key& key : keys()) {
    if (key.kind != KeyKind::kSensor && key.kind != KeyKind::kDepthCamera) continue;
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
    const Status status =
        camera_matrix(root) ? from_camera_info(path, root, collector) : from_keys(root, collector);
    return status.ok() ? collector.finish(calibration) : status;
  } catch (const YAML::Exception& error) {
    return damaged(path, error.what());
  }
}

}  // namespace plvo::calibration_form
