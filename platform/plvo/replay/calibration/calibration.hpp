// SPDX-License-Identifier: Apache-2.0
// Camera calibrations from files and by name. Forms that are understood, told apart by their content (YAML by
// the extension .yaml or .yml):
//   fx fy cx cy [depth_scale [k1 k2 p1 p2 k3 [readout_s]]]   numbers in this order; lines with keys may
//   follow fx 0 cx 0  0 fy cy 0  0 0 1 0  0 0 0 1                   the same of a matrix, as ScanNet's are
//   fx: 525  (or fx = 525, or fx 525), one a line            keys in any order: calibration_keys.hpp has them
//   YAML with the same keys
//   ROS camera_info YAML                                     image_width, camera_matrix, the lens
//                                                            (camera_info.hpp), and beside them the sensor's
//                                                            keys
// What a source does not say is assumed, and known to be: see assumptions().
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/replay/images/depth_registration.hpp"

namespace plvo {

inline constexpr double kTumDepthUnitsPerMetre = 5000;

struct Calibration {
  CameraModel camera;     // width and height hold for has_size only; else the images decide
  bool has_size = false;  // the source says which image size it is for
  double depth_units_per_metre = kTumDepthUnitsPerMetre;
  bool depth_scale_given = false;  // by the source or a flag; else the default above is a guess
  DepthCamera depth_camera;        // of depth that is not registered to colour
  bool readout_given = false;      // of the rolling shutter, 0 included; else a global shutter is a guess

  // As CameraModel::validate for colour images of this size, a depth scale between 1 and 100000 units per
  // metre, and a depth camera that is one.
  Status validate(int width, int height) const;

  // What was not said and is therefore assumed: a sentence each, with what to do if it is wrong. To be shown
  // to whoever runs a recorded sequence; empty when all was said.
  std::vector<std::string> assumptions() const;
};

// kNotFound, kDamaged (what is expected and where), kInvalidArgument (not a regular file, or larger than a
// calibration can be), kUnsupported for a lens that plvo does not know. On failure `calibration` is
// unchanged.
Status read_calibration(const std::filesystem::path& path, Calibration& calibration);

// The calibration that lies beside a recorded sequence: the first that is there of calibration.txt,
// calibration.yaml, camera.yaml, and of what ScanNet's exports have, intrinsic/intrinsic_depth.txt and
// intrinsic/intrinsic_color.txt (of images of one size; both cameras are read by scannet_cameras.hpp).
std::optional<std::filesystem::path> calibration_file_in(const std::filesystem::path& folder);

// tum-fr1, tum-fr2, tum-fr3 (the values the benchmark publishes), 7scenes (as its page says),
// kinect-v1-default. kNotFound lists the names.
Status builtin_calibration(std::string_view name, Calibration& calibration);
std::span<const std::string_view> builtin_calibration_names();

// Where one word stands for either: one of those names, or else a file, as read_calibration.
Status named_calibration(const std::string& name_or_file, Calibration& calibration);

// As read_calibration takes it back, to the last bit: one line of numbers (as many as say something), and a
// line `key value` for each property of the sensor that has no place among them and is not at its default.
// The size is not written: the images beside it have it.
std::string calibration_text(const Calibration& calibration);

// The same with a key on each line, `fx: 525`, which reads as text and as YAML; the size too, where it has
// one.
std::string calibration_lines(const Calibration& calibration);

}  // namespace plvo
