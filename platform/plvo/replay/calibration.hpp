// SPDX-License-Identifier: Apache-2.0
// Camera calibrations from files and by name. Three forms are understood:
//   fx fy cx cy depth_scale [k1 k2 p1 p2 k3]        numbers in this order (calibration.txt)
//   fx: 525  (or fx = 525, or fx 525), one a line   the same names as keys, in any order; also width, height
//   ROS camera_info YAML                            image_width, camera_matrix, plumb_bob distortion
// depth_scale is the depth image's units per metre: 5000 in TUM folders, 1000 for millimetres.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"

namespace plvo {

inline constexpr double kTumDepthUnitsPerMetre = 5000;

struct Calibration {
  CameraModel camera;     // width and height hold for has_size only; else the images decide
  bool has_size = false;  // the source says which image size it is for
  double depth_units_per_metre = kTumDepthUnitsPerMetre;

  // As CameraModel::validate for images of this size, and a depth scale that is a positive number.
  Status validate(int width, int height) const;
};

// The form is told by the content (YAML by the extension .yaml or .yml). kNotFound, kDamaged (what is
// expected and where), kUnsupported for a distortion model other than plumb_bob. On failure `calibration` is
// unchanged.
Status read_calibration(const std::filesystem::path& path, Calibration& calibration);

// tum-fr1, tum-fr2, tum-fr3 (the values the benchmark publishes), kinect-v1-default. kNotFound lists the
// names.
Status builtin_calibration(std::string_view name, Calibration& calibration);
std::span<const std::string_view> builtin_calibration_names();

// read_calibration for a YAML file.
Status read_camera_info(const std::filesystem::path& path, Calibration& calibration);

}  // namespace plvo
