// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/calibration/calibration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "plvo/host/files/input_file.hpp"
#include "plvo/replay/calibration/calibration_keys.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 5> kBuiltinNames = {"tum-fr1", "tum-fr2", "tum-fr3", "7scenes",
                                                           "kinect-v1-default"};
// TUM's computer stamped colour in steps of 4 ms (the 32 and 36 ms between two of fr1's), at random within
// one.
constexpr double kTumStampSigma_s = 0.0012;
constexpr std::uintmax_t kMaxBytes = 1u << 20;  // of a calibration, whatever comments it has

}  // namespace

Status Calibration::validate(int width, int height) const {
  if (has_size && (camera.width != width || camera.height != height)) {
    return {
        StatusCode::kInvalidArgument,
        fmt::format(
            "the calibration is for {}x{} images, these are {}x{}; use the calibration of this camera mode",
            camera.width, camera.height, width, height)};
  }
  if (!(depth_units_per_metre >= 1 && depth_units_per_metre <= 100000)) {
    return {StatusCode::kInvalidArgument,
            "camera calibration: depth_scale must lie between 1 and 100000 units per metre, not metres per "
            "unit (5000 for TUM, 1000 for mm)"};
  }
  if (depth_camera.known) {
    const DepthCamera& depth = depth_camera;
    const auto is_number = [](double x) { return x - x == 0; };
    if (!is_number(depth.pinhole.fx) || !is_number(depth.pinhole.fy) || depth.pinhole.fx <= 0 ||
        depth.pinhole.fy <= 0 || !is_number(depth.pinhole.cx) || !is_number(depth.pinhole.cy))
      return {
          StatusCode::kInvalidArgument,
          "camera calibration: depth_fx and depth_fy must be positive, depth_cx and depth_cy numbers (pixels "
          "of the depth image)"};
    if (!(depth.tx * depth.tx + depth.ty * depth.ty + depth.tz * depth.tz <= 1))
      return {
          StatusCode::kInvalidArgument,
          "camera calibration: depth_tx depth_ty depth_tz are metres, at most 1 m from the colour camera"};
    const double length2 =
        depth.qx * depth.qx + depth.qy * depth.qy + depth.qz * depth.qz + depth.qw * depth.qw;
    if (!(length2 >= 0.98 && length2 <= 1.02))
      return {
          StatusCode::kInvalidArgument,
          "camera calibration: the quaternion depth_qx depth_qy depth_qz depth_qw must have the length 1"};
  }
  const Pinhole& pinhole = camera.pinhole;
  if (pinhole.cx >= width || pinhole.cy >= height)
    return {StatusCode::kInvalidArgument,
            fmt::format(
                "the principal point ({:.1f}, {:.1f}) lies outside the {}x{} images: the calibration is of "
                "another size, or cx and cy are exchanged; use the calibration of this camera mode",
                pinhole.cx, pinhole.cy, width, height)};
  CameraModel sized = camera;
  sized.width = width;
  sized.height = height;
  return sized.validate();
}

std::vector<std::string> Calibration::assumptions() const {
  std::vector<std::string> sentences;
  if (!depth_scale_given) {
    sentences.push_back(fmt::format(
        "the calibration does not say the unit of depth: {} units per metre are assumed; for millimetres "
        "give depth_scale 1000 in it, or --depth-scale 1000",
        depth_units_per_metre));
  }
  if (!readout_given) {
    sentences.push_back(
        fmt::format("the calibration does not say how the colour camera's shutter rolls: a global shutter is "
                    "assumed; for "
                    "a Kinect v1 give readout_s {0} in it, or --readout {0} (0 says global, too)",
                    kKinectReadout_s));
  }
  return sentences;
}

Status read_calibration(const fs::path& path, Calibration& calibration) {
  std::string content;
  if (Status status = read_text_file(path, kMaxBytes, content); !status.ok())
    return Status(status.code(), "calibration: ").append(status.message());
  const bool yaml = path.extension() == ".yaml" || path.extension() == ".yml";
  return yaml ? calibration_form::parse_yaml(path, content, calibration)
              : calibration_form::parse_text(path, content, calibration);
}

std::optional<fs::path> calibration_file_in(const fs::path& folder) {
  std::error_code error;
  for (const char* name : {"calibration.txt", "calibration.yaml", "camera.yaml",
                           "intrinsic/intrinsic_depth.txt", "intrinsic/intrinsic_color.txt"})
    if (fs::exists(folder / name, error)) return folder / name;
  return {};
}

std::span<const std::string_view> builtin_calibration_names() { return kBuiltinNames; }

Status builtin_calibration(std::string_view name, Calibration& calibration) {
  Calibration result;
  result.has_size = true;
  CameraModel& camera = result.camera;
  camera.readout_s = kKinectReadout_s;  // all of these are Kinects v1 or their relatives
  result.readout_given = true;
  result.depth_scale_given =
      name.starts_with("tum-");  // a Kinect's own depth is in whatever its program wrote
  if (name.starts_with("tum-")) camera.stamp_sigma_s = kTumStampSigma_s;
  if (name == "tum-fr1") {
    camera.pinhole = {517.306408, 516.469215, 318.643040, 255.313989};
    camera.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
    // These recordings stamp depth some 15 ms later than it was exposed (docs/sensors.md).
    camera.depth_timing = {.known = true, .delay_s = -0.015, .readout_s = kKinectReadout_s};
  } else if (name == "tum-fr2") {
    camera.pinhole = {520.908620, 521.007327, 325.141442, 249.701764};
    camera.distortion = {0.231222, -0.784899, -0.003257, -0.000105, 0.917205};
  } else if (name == "tum-fr3") {
    camera.pinhole = {535.4, 539.2, 320.1, 247.6};
  } else if (name == "7scenes") {
    camera.pinhole = {585, 585, 320, 240};
    result.depth_units_per_metre = 1000;
    result.depth_scale_given = true;
  } else if (name == "kinect-v1-default") {
    camera.pinhole = {525, 525, 319.5, 239.5};
  } else {
    std::string names;
    for (std::string_view known : kBuiltinNames) names += fmt::format(" {}", known);
    return {StatusCode::kNotFound,
            fmt::format("camera model '{}' is not known; the names are{}", name, names)};
  }
  calibration = result;
  return {};
}

Status named_calibration(const std::string& name_or_file, Calibration& calibration) {
  const bool named =
      std::find(kBuiltinNames.begin(), kBuiltinNames.end(), name_or_file) != kBuiltinNames.end();
  return named ? builtin_calibration(name_or_file, calibration) : read_calibration(name_or_file, calibration);
}

}  // namespace plvo
