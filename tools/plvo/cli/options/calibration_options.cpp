// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <utility>

#include "plvo/camera/camera_info.hpp"
#include "plvo/camera/focal_range.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/camera_options.hpp"

namespace plvo::cli {
namespace {

constexpr NumberRange kFocal_px = {kLeastFocal_px, kMostFocal_px};
constexpr NumberRange kCentre_px = {-100'000, 100'000};
constexpr NumberRange kUnitsPerMetre = {kLeastUnitsPerMetre, kMostUnitsPerMetre};
constexpr NumberRange kReadout_s = {0, 1};
constexpr NumberRange kStampSigma_s = {0, 0.1};
constexpr NumberRange kDistortion = {-1000, 1000};

std::vector<std::string> builtin_names() {
  const auto names = builtin_calibration_names();
  return {names.begin(), names.end()};
}

}  // namespace

void add_calibration_options(CLI::App& command, CalibrationOptions& options, DepthScale depth_scale,
                             const std::string& fallback) {
  OptionGroup group(command, kCalibrationGroup);
  group.path(
      "--calibration", options.file,
      "Calibration file: 'fx fy cx cy depth_scale ...', a matrix, or YAML or JSON of ROS, Kalibr, EuRoC, "
      "ORB-SLAM or Open3D (share/doc/plvo/user/calibration.md). Without it and the options below: " +
          fallback);
  Choices<std::string> models;
  for (const std::string& name : builtin_names()) models.emplace_back(name, name);
  group.choice("--camera-model", options.model_name, models, "Calibration of a camera by its name");
  group.number("--fx", options.fx, kFocal_px, "PIXELS", "Focal length, horizontal");
  group.number("--fy", options.fy, kFocal_px, "PIXELS", "Focal length, vertical");
  group.number("--cx", options.cx, kCentre_px, "PIXELS", "Principal point, horizontal");
  group.number("--cy", options.cy, kCentre_px, "PIXELS", "Principal point, vertical");
  if (depth_scale == DepthScale::kAsked)
    group.number("--depth-scale", options.depth_scale, kUnitsPerMetre, "UNITS",
                 "Units of the depth images per metre: 5000 in TUM recordings, 1000 for millimetres");
  group.number(
      "--readout", options.readout_s, kReadout_s, "SECONDS",
      fmt::format("Rolling shutter: time from the first row to the last; Kinect v1: {}, global shutter: 0",
                  kKinectReadout_s));
  group.number("--stamp-sigma", options.stamp_sigma_s, kStampSigma_s, "SECONDS",
               "How far a colour stamp is off the exposure, standard deviation; widens the covariances (TUM "
               "recordings: 0.0012)");
  const auto add_lens = [&](const char* option, const char* model, const char* what, int least, int most) {
    CLI::Option* lens =
        group.add(option, "NUMBER", what, [&options, model = std::string(model)](const std::string& text) {
          double number = 0;
          std::string wrong = read_number(text, kDistortion, number);
          options.distortion_model = model;
          if (wrong.empty()) options.distortion.push_back(number);
          return wrong;
        });
    takes_values(lens, least, most);
  };
  add_lens("--distortion", "plumb_bob", "Lens distortion: k1 k2 p1 p2 [k3]", 4, 5);
  add_lens("--distortion-rational", "rational_polynomial", "Lens distortion: k1 k2 p1 p2 k3 k4 k5 k6", 8, 8);
  add_lens("--distortion-equidistant", "equidistant", "Lens distortion of a fisheye: k1 k2 k3 k4", 4, 4);
}

void check_calibration_options(const CLI::App& command) {
  if (given(command, "--calibration"))
    refuse_options(command, {"--camera-model"}, "cannot be combined with --calibration; give one of them");
  for (const auto& [one, other] : {std::pair("--fx", "--fy"), std::pair("--fy", "--fx")})
    if (given(command, one) && !given(command, other))
      refuse(one,
             fmt::format("pixels are square, so that one focal length alone changes the picture's shape; "
                         "give {} as well",
                         other));
  if (given(command, "--distortion") + given(command, "--distortion-rational") +
          given(command, "--distortion-equidistant") >
      1)
    refuse("--distortion", "give one of --distortion, --distortion-rational and --distortion-equidistant");
}

Status find_calibration(const CalibrationOptions& options, const std::function<Status(Calibration&)>& own,
                        Calibration& calibration) {
  const bool any_pinhole = options.fx || options.fy || options.cx || options.cy;
  const bool all_pinhole = options.fx && options.fy && options.cx && options.cy;
  Status status;
  if (!options.file.empty()) {
    status = read_calibration(options.file, calibration);
  } else if (!options.model_name.empty()) {
    status = builtin_calibration(options.model_name, calibration);
  } else if (!all_pinhole) {
    status = own(calibration);
    if (status.code() == StatusCode::kNotFound)
      status = {
          StatusCode::kInvalidArgument,
          fmt::format(
              "no calibration: give --calibration FILE, --camera-model NAME ({}), or --fx --fy --cx --cy; {}",
              any_of(builtin_names()), status.message())};
  }
  if (!status.ok()) return status;
  Pinhole& pinhole = calibration.camera.pinhole;
  if (any_pinhole) {
    calibration.guess.clear();
    pinhole = {options.fx.value_or(pinhole.fx), options.fy.value_or(pinhole.fy),
               options.cx.value_or(pinhole.cx), options.cy.value_or(pinhole.cy)};
  }
  if (!options.distortion.empty())
    status = distortion_of(options.distortion_model, options.distortion, calibration.camera.distortion);
  if (options.readout_s) calibration.camera.readout_s = *options.readout_s;
  calibration.readout_given |= options.readout_s.has_value();
  if (options.stamp_sigma_s) calibration.camera.stamp_sigma_s = *options.stamp_sigma_s;
  if (options.depth_scale) calibration.depth_units_per_metre = *options.depth_scale;
  calibration.depth_scale_given |= options.depth_scale.has_value();
  return status;
}

}  // namespace plvo::cli
