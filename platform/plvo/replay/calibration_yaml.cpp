// SPDX-License-Identifier: Apache-2.0
// ROS camera_info as the calibration tools write it (image_width, camera_matrix: {data: …}, distortion_model,
// distortion_coefficients: {data: …}) and as a printed message shows it (width, K or k, D or d).
#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "plvo/replay/calibration.hpp"

namespace plvo {
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

Status from_yaml(const fs::path& path, const YAML::Node& root, Calibration& calibration) {
  const auto damaged = [&path](std::string_view what) {
    return Status(StatusCode::kDamaged, fmt::format("{}: {}", path.string(), what));
  };
  if (!root.IsMap())
    return damaged("is not a camera_info: expected keys such as image_width and camera_matrix");
  const std::vector<double> K = numbers(first_of(root, {"camera_matrix", "K", "k"}));
  if (K.size() != 9) return damaged("camera_matrix must have 9 numbers (fx 0 cx 0 fy cy 0 0 1)");
  const std::vector<double> D = numbers(first_of(root, {"distortion_coefficients", "D", "d"}));
  const YAML::Node model_node = first_of(root, {"distortion_model"});
  const std::string model = model_node ? model_node.as<std::string>() : "plumb_bob";
  if (model != "plumb_bob" && !model.empty()) {
    return {
        StatusCode::kUnsupported,
        fmt::format(
            "{}: distortion model '{}' is not supported, only plumb_bob (k1 k2 p1 p2 k3); calibrate again "
            "with it, or undistort the images first",
            path.string(), model)};
  }
  if (!D.empty() && D.size() != 4 && D.size() != 5)
    return damaged(fmt::format("plumb_bob has 4 or 5 distortion coefficients, not {}", D.size()));

  calibration.camera.pinhole = {K[0], K[4], K[2], K[5]};
  if (!D.empty()) calibration.camera.distortion = {D[0], D[1], D[2], D[3], D.size() > 4 ? D[4] : 0.0};
  const YAML::Node width = first_of(root, {"image_width", "width"});
  const YAML::Node height = first_of(root, {"image_height", "height"});
  if (width && height) {
    calibration.has_size = true;
    calibration.camera.width = width.as<int>();
    calibration.camera.height = height.as<int>();
  }
  if (const YAML::Node scale = root["depth_scale"]; scale)
    calibration.depth_units_per_metre = scale.as<double>();
  return {};
}

}  // namespace

Status read_camera_info(const fs::path& path, Calibration& calibration) {
  try {
    Calibration result;
    const Status status = from_yaml(path, YAML::LoadFile(path.string()), result);
    if (status.ok()) calibration = result;
    return status;
  } catch (const YAML::BadFile&) {
    return {StatusCode::kNotFound, fmt::format("cannot read the calibration {}", path.string())};
  } catch (const YAML::Exception& error) {
    return {StatusCode::kDamaged, fmt::format("{}: {}", path.string(), error.what())};
  }
}

}  // namespace plvo
