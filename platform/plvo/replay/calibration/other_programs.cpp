// SPDX-License-Identifier: Apache-2.0
// Calibrations as other programs write them:
//   Kalibr      camchain.yaml: for each camera cam0, cam1 … camera_model, intrinsics [fx, fy, cx, cy],
//               distortion_model, distortion_coeffs, resolution [width, height], rostopic
//   EuRoC       sensor.yaml: the same of one camera, without cam0, and with distortion_coefficients
//   ORB-SLAM    settings: Camera.fx or Camera1.fx …, Camera.k1 …, Camera.width, DepthMapFactor
//   Open3D      camera_intrinsic.json: width, height, intrinsic_matrix column by column
#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "plvo/camera/camera_info.hpp"
#include "plvo/replay/calibration/yaml_nodes.hpp"
#include "plvo/replay/small_letters.hpp"

namespace plvo::calibration_form {
namespace {

namespace fs = std::filesystem;

bool is_chain(const YAML::Node& root) {
  return std::any_of(root.begin(), root.end(),
                     [](const auto& entry) { return entry.second.IsMap() && entry.second["intrinsics"]; });
}

bool speaks_of_colour(const std::string& topic) {
  const std::string name = in_small_letters(topic);
  return name.find("rgb") != name.npos || name.find("color") != name.npos || name.find("colour") != name.npos;
}

// Translates the names of lens models of Kalibr and EuRoC to those of a camera_info.
std::string lens_name(const std::string& model) {
  if (model == "radtan" || model == "radial-tangential") return "plumb_bob";
  if (model == "equi") return "equidistant";
  return model == "none" ? "" : model;
}

Status from_intrinsics(const fs::path& path, const YAML::Node& camera, Collector& collector) {
  const std::string model = text_of(camera["camera_model"]);
  if (!model.empty() && model != "pinhole")
    return {StatusCode::kUnsupported,
            fmt::format("{}: camera_model '{}' is not supported, only pinhole; calibrate again with it, or "
                        "undistort the images first",
                        path.string(), model.substr(0, 40))};
  const std::vector<double> intrinsics = numbers(camera["intrinsics"]);
  if (intrinsics.size() != 4) return damaged(path, "intrinsics must have 4 numbers, fx fy cx cy");
  Distortion lens;
  const std::vector<double> coefficients =
      numbers(first_of(camera, {"distortion_coeffs", "distortion_coefficients"}));
  const Status known = distortion_of(lens_name(text_of(camera["distortion_model"])), coefficients, lens);
  if (!known.ok()) return of_file(path, known);
  collector.set_lens({intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3]}, lens);
  const YAML::Node size = camera["resolution"];
  if (!size) return {};
  if (!size.IsSequence() || size.size() != 2) return damaged(path, "resolution must be [width, height]");
  return set_size(collector, size[0], size[1]);
}

// Takes the camera whose topic names colour, else the first.
Status from_chain(const fs::path& path, const YAML::Node& root, Collector& collector) {
  std::string first, colour;
  int cameras = 0;
  for (const auto& entry : root) {
    if (!entry.second.IsMap() || !entry.second["intrinsics"]) continue;
    const std::string name = entry.first.as<std::string>();
    ++cameras;
    if (first.empty() || name < first) first = name;
    if (colour.empty() && speaks_of_colour(text_of(entry.second["rostopic"]))) colour = name;
  }
  if (cameras > 1 && colour.empty())
    collector.set_guess(fmt::format(
        "{} has {} cameras, and no rostopic says which took the colour images: {} is taken; put the right "
        "one into a file of its own if it is another",
        path.filename().string(), cameras, first));
  return from_intrinsics(path, root[colour.empty() ? first : colour], collector);
}

Status from_orb_slam(const fs::path& path, const YAML::Node& root, Collector& collector) {
  const std::string prefix = root["Camera.fx"] ? "Camera." : "Camera1.";
  const std::string type = text_of(root["Camera.type"]);
  const bool fisheye = type == "KannalaBrandt8";
  if (!type.empty() && !fisheye && type != "PinHole" && type != "Pinhole" && type != "Rectified")
    return {StatusCode::kUnsupported,
            fmt::format("{}: Camera.type '{}' is not supported, only PinHole, Rectified and KannalaBrandt8",
                        path.string(), type.substr(0, 40))};
  if (fisheye)
    if (Status status = collector.set(kLensModelKey, "equidistant"); !status.ok()) return status;
  constexpr std::array<const char*, 10> kNames = {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4"};
  const std::size_t wanted = type == "Rectified" ? 4 : kNames.size();
  for (std::size_t i = 0; i < wanted; ++i)
    if (const YAML::Node value = root[prefix + kNames[i]]; value)
      if (Status status = set(collector, kNames[i], value); !status.ok()) return status;
  Status status = set_size(collector, root["Camera.width"], root["Camera.height"]);
  const YAML::Node scale = first_of(root, {"DepthMapFactor", "RGBD.DepthMapFactor"});
  return status.ok() && scale ? set(collector, "depth_scale", scale) : status;
}

Status from_open3d(const fs::path& path, const YAML::Node& root, Collector& collector) {
  const std::vector<double> m = numbers(root["intrinsic_matrix"]);
  const bool fits = m.size() == 9 && m[1] == 0 && m[2] == 0 && m[3] == 0 && m[5] == 0 && m[8] == 1;
  if (!fits)
    return damaged(path, "intrinsic_matrix must have 9 numbers, column by column: fx 0 0 0 fy 0 cx cy 1");
  collector.set_lens({m[0], m[4], m[6], m[7]}, {});
  return set_size(collector, root["width"], root["height"]);
}

}  // namespace

YamlReader reader_of_other_programs(const YAML::Node& root) {
  if (root["Camera.fx"] || root["Camera1.fx"]) return &from_orb_slam;
  if (root["intrinsic_matrix"]) return &from_open3d;
  if (root["intrinsics"]) return &from_intrinsics;
  return is_chain(root) ? &from_chain : nullptr;
}

}  // namespace plvo::calibration_form
