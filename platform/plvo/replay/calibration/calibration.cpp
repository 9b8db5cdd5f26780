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
// TUM's computer stamped colour in steps of 4 ms (fr1 has intervals of 32 and 36 ms); the error is random
// within a step.
constexpr double kTumStampSigma_s = 0.0012;
// A Kinect v1's colour camera: the default of ROS's driver (openni_camera) for uncalibrated ones.
constexpr Pinhole kKinectColour = {525, 525, 319.5, 239.5};
// Its colour camera is to the right of the depth camera (kinect_frames.launch of openni_launch).
constexpr double kKinectDepth_tx = -0.025;

Status validate_depth_camera(const DepthCamera& depth, int width, int height) {
  const auto invalid = [](std::string_view what) {
    return Status(StatusCode::kInvalidArgument, "camera calibration: ").append(what);
  };
  if (!(depth.tx * depth.tx + depth.ty * depth.ty + depth.tz * depth.tz <= kMostOffset_m * kMostOffset_m))
    return invalid(fmt::format("depth_tx depth_ty depth_tz are metres, at most {} m from the colour camera",
                               kMostOffset_m));
  const double length2 =
      depth.qx * depth.qx + depth.qy * depth.qy + depth.qz * depth.qz + depth.qw * depth.qw;
  if (!(length2 >= 0.98 && length2 <= 1.02))
    return invalid("the quaternion depth_qx depth_qy depth_qz depth_qw must have the length 1");
  if (depth.as_colour) return {};
  CameraModel camera;
  camera.width = width;
  camera.height = height;
  camera.pinhole = depth.pinhole;
  const Status status = camera.validate();
  return status.ok() ? status
                     : Status(status.code(), fmt::format("depth_fx depth_fy depth_cx depth_cy, of the "
                                                         "camera of depth images of {}x{}: {}",
                                                         width, height, status.message()));
}

}  // namespace

Status Calibration::validate(int width, int height, int depth_width, int depth_height) const {
  if (has_size && (camera.width != width || camera.height != height)) {
    return {
        StatusCode::kInvalidArgument,
        fmt::format(
            "the calibration is for {}x{} images, these are {}x{}; use the calibration of this camera mode",
            camera.width, camera.height, width, height)};
  }
  if (!(depth_units_per_metre >= kLeastUnitsPerMetre && depth_units_per_metre <= kMostUnitsPerMetre)) {
    return {StatusCode::kInvalidArgument,
            fmt::format("camera calibration: depth_scale must lie between {} and {} units per metre, not "
                        "metres per unit (5000 for TUM, 1000 for mm)",
                        kLeastUnitsPerMetre, kMostUnitsPerMetre)};
  }
  if (depth_camera.known)
    if (Status status = validate_depth_camera(depth_camera, depth_width, depth_height); !status.ok())
      return status;
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
  if (!guess.empty()) sentences.push_back(guess);
  if (!depth_scale_given) {
    sentences.push_back(fmt::format(
        "the calibration does not say the unit of depth: {} units per metre are assumed; give depth_scale "
        "in it, or --depth-scale: {} for millimetres, {} for TUM's",
        depth_units_per_metre, kMillimetresPerMetre, kTumDepthUnitsPerMetre));
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
  if (Status status = read_text_file(path, kMaxCalibrationBytes, content); !status.ok())
    return Status(status.code(), "calibration: ").append(status.message());
  const fs::path extension = path.extension();
  const bool yaml = extension == ".yaml" || extension == ".yml" || extension == ".json" ||
                    content.starts_with("%YAML") || content.starts_with('{');
  return yaml ? calibration_form::parse_yaml(path, content, calibration)
              : calibration_form::parse_text(path, content, calibration);
}

std::optional<fs::path> calibration_file_in(const fs::path& folder) {
  constexpr auto kNames = std::to_array<const char*>({
      "calibration.txt",
      "calibration.yaml",
      "camera.yaml",
      "calibration.yml",
      "camera.yml",
      "camera_info.yaml",
      "camera_intrinsic.json",  // Open3D
      "camera_intrinsics.json",
      "intrinsic.json",
      "intrinsics.json",
      "camchain.yaml",     // Kalibr
      "sensor.yaml",       // EuRoC
      "cam0/sensor.yaml",  // EuRoC
      "camera-intrinsics.txt",
      "camera_intrinsics.txt",
      "camera_intrinsic.txt",
      "intrinsics.txt",
      "intrinsic.txt",
      "cam_K.txt",
      "K.txt",
      "../camera-intrinsics.txt",  // 3DMatch: one for all sequences of a scene
      "intrinsic/intrinsic_depth.txt",
      "intrinsic/intrinsic_color.txt",
  });
  std::error_code error;
  for (const char* name : kNames)
    if (fs::exists(folder / name, error)) return folder / name;
  return {};
}

std::span<const std::string_view> builtin_calibration_names() { return kBuiltinNames; }

Status builtin_calibration(std::string_view name, Calibration& calibration) {
  Calibration result;
  result.has_size = true;
  CameraModel& camera = result.camera;
  camera.readout_s = kKinectReadout_s;  // all of these are Kinects v1 or similar sensors
  result.readout_given = true;
  result.depth_scale_given =
      name.starts_with("tum-");  // the unit of a Kinect's depth depends on the recording program
  if (name.starts_with("tum-")) camera.stamp_sigma_s = kTumStampSigma_s;
  if (name == "tum-fr1") {
    camera.pinhole = {517.306408, 516.469215, 318.643040, 255.313989};
    camera.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
    // In these recordings, the stamp of depth is some 15 ms later than its exposure
    // (docs/decisions/tum_fr1_delay.md).
    camera.depth_timing = {.known = true, .delay_s = -0.015, .readout_s = kKinectReadout_s};
  } else if (name == "tum-fr2") {
    camera.pinhole = {520.908620, 521.007327, 325.141442, 249.701764};
    camera.distortion = {0.231222, -0.784899, -0.003257, -0.000105, 0.917205};
  } else if (name == "tum-fr3") {
    camera.pinhole = {535.4, 539.2, 320.1, 247.6};
  } else if (name == "7scenes") {
    camera.pinhole = kKinectColour;
    result.depth_camera = {.known = true, .pinhole = {585, 585, 320, 240}, .tx = kKinectDepth_tx};
    result.depth_units_per_metre = kMillimetresPerMetre;
    result.depth_scale_given = true;
    result.guess = fmt::format(
        "7scenes: colour's camera is a guess, because its page gives only depth's: {} px, what ROS takes for "
        "a "
        "Kinect v1 that nobody calibrated, {} mm beside depth's; a better one: --calibration FILE",
        kKinectColour.fx, -1000 * kKinectDepth_tx);
  } else if (name == "kinect-v1-default") {
    camera.pinhole = kKinectColour;
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
