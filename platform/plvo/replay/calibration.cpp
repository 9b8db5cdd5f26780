// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/calibration.hpp"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace plvo {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> kBuiltinNames = {"tum-fr1", "tum-fr2", "tum-fr3",
                                                           "kinect-v1-default"};

Status damaged(const fs::path& path, std::string_view what) {
  return {StatusCode::kDamaged, fmt::format("{}: {}", path.string(), what)};
}

bool parse_number(std::string_view text, double& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

// Words of the file without comments; ':', '=', ',' count as white space.
std::vector<std::string> read_words(std::istream& stream) {
  std::vector<std::string> words;
  std::string line;
  while (std::getline(stream, line)) {
    std::string word;
    for (char c : line.substr(0, line.find('#')) + ' ') {
      const bool separator = c == ' ' || c == '\t' || c == '\r' || c == ':' || c == '=' || c == ',';
      if (!separator) word += c;
      if (separator && !word.empty()) words.push_back(std::exchange(word, {}));
    }
  }
  return words;
}

Status from_numbers(const fs::path& path, const std::vector<std::string>& words, Calibration& calibration) {
  if (words.size() != 5 && words.size() != 10 && words.size() != 11) {
    return damaged(
        path, fmt::format("has {} numbers; expected 'fx fy cx cy depth_scale' or 'fx fy cx cy depth_scale "
                          "k1 k2 p1 p2 k3 [readout_s]'",
                          words.size()));
  }
  std::array<double, 11> values{};
  for (std::size_t i = 0; i < words.size(); ++i)
    if (!parse_number(words[i], values[i]))
      return damaged(path, fmt::format("'{}' is not a number", words[i]));
  calibration.camera.pinhole = {values[0], values[1], values[2], values[3]};
  calibration.depth_units_per_metre = values[4];
  calibration.camera.distortion = {values[5], values[6], values[7], values[8], values[9]};
  calibration.camera.readout_s = values[10];
  return {};
}

Status from_keys(const fs::path& path, const std::vector<std::string>& words, Calibration& calibration) {
  double width = 0;
  double height = 0;
  Pinhole& pinhole = calibration.camera.pinhole;
  Distortion& lens = calibration.camera.distortion;
  pinhole = {0, 0, -1, -1};
  const std::array<std::pair<std::string_view, double*>, 13> keys = {
      {{"fx", &pinhole.fx},
       {"fy", &pinhole.fy},
       {"cx", &pinhole.cx},
       {"cy", &pinhole.cy},
       {"depth_scale", &calibration.depth_units_per_metre},
       {"k1", &lens.k1},
       {"k2", &lens.k2},
       {"p1", &lens.p1},
       {"p2", &lens.p2},
       {"k3", &lens.k3},
       {"readout_s", &calibration.camera.readout_s},
       {"width", &width},
       {"height", &height}}};
  for (std::size_t i = 0; i < words.size(); i += 2) {
    double* target = nullptr;
    for (const auto& [key, value] : keys)
      if (words[i] == key) target = value;
    if (target == nullptr) {
      return damaged(path,
                     fmt::format("'{}' is not known; the keys are fx fy cx cy depth_scale k1 k2 p1 p2 k3 "
                                 "readout_s width height",
                                 words[i]));
    }
    if (i + 1 >= words.size() || !parse_number(words[i + 1], *target))
      return damaged(path, fmt::format("'{}' needs a number after it", words[i]));
  }
  if (pinhole.fx == 0 || pinhole.fy == 0 || pinhole.cx == -1 || pinhole.cy == -1)
    return damaged(path, "fx, fy, cx and cy must all be given");
  if (width > 0 && height > 0) {
    calibration.has_size = true;
    calibration.camera.width = static_cast<int>(width);
    calibration.camera.height = static_cast<int>(height);
  }
  return {};
}

}  // namespace

Status Calibration::validate(int width, int height) const {
  if (has_size && (camera.width != width || camera.height != height)) {
    return {
        StatusCode::kInvalidArgument,
        fmt::format(
            "the calibration is for {}x{} images, these are {}x{}; use the calibration of this camera mode",
            camera.width, camera.height, width, height)};
  }
  if (!std::isfinite(depth_units_per_metre) || depth_units_per_metre <= 0) {
    return {StatusCode::kInvalidArgument,
            "camera calibration: depth_scale must be a positive number (units per metre: 5000 for TUM, 1000 "
            "for mm)"};
  }
  CameraModel sized = camera;
  sized.width = width;
  sized.height = height;
  return sized.validate();
}

Status read_calibration(const fs::path& path, Calibration& calibration) {
  if (path.extension() == ".yaml" || path.extension() == ".yml") return read_camera_info(path, calibration);
  std::ifstream stream(path);
  if (!stream) return {StatusCode::kNotFound, fmt::format("cannot read the calibration {}", path.string())};
  const std::vector<std::string> words = read_words(stream);
  if (words.empty())
    return damaged(path, "is empty; expected 'fx fy cx cy depth_scale [k1 k2 p1 p2 k3 [readout_s]]'");
  double number = 0;
  Calibration result;
  const Status status =
      parse_number(words[0], number) ? from_numbers(path, words, result) : from_keys(path, words, result);
  if (status.ok()) calibration = result;
  return status;
}

std::span<const std::string_view> builtin_calibration_names() { return kBuiltinNames; }

Status builtin_calibration(std::string_view name, Calibration& calibration) {
  Calibration result;
  result.has_size = true;
  CameraModel& camera = result.camera;
  camera.readout_s = kKinectReadout_s;  // all of these are Kinects v1 or their relatives
  if (name == "tum-fr1") {
    camera.pinhole = {517.306408, 516.469215, 318.643040, 255.313989};
    camera.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
  } else if (name == "tum-fr2") {
    camera.pinhole = {520.908620, 521.007327, 325.141442, 249.701764};
    camera.distortion = {0.231222, -0.784899, -0.003257, -0.000105, 0.917205};
  } else if (name == "tum-fr3") {
    camera.pinhole = {535.4, 539.2, 320.1, 247.6};
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

}  // namespace plvo
