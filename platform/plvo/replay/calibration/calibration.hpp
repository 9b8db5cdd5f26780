// SPDX-License-Identifier: Apache-2.0
// Camera calibrations from files and by name. Forms that are understood, told apart by their content (YAML by
// the extensions .yaml, .yml and .json too):
//   fx fy cx cy [depth_scale [k1 k2 p1 p2 k3 [readout_s]]]   numbers in this order; keys may follow
//   fx 0 cx  0 fy cy  0 0 1                                  the same of a matrix; also of four rows and
//                                                            columns, as ScanNet's are
//   fx: 525  (or fx = 525, or fx 525), one a line            keys in any order, those of
//                                                            calibration_keys.hpp
//   YAML with the same keys
//   ROS camera_info YAML                                     image_width, camera_matrix, the lens
//                                                            (camera_info.hpp)
//   YAML and JSON of Kalibr, EuRoC, ORB-SLAM and Open3D      other_programs.cpp
// Beside the words of another program the sensor's keys may stand. What a source does not say is assumed, and
// known to be: see assumptions().
#pragma once

#include <cstdint>
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
inline constexpr double kMillimetresPerMetre = 1000;
inline constexpr int kLeastUnitsPerMetre = 1, kMostUnitsPerMetre = 100'000;
inline constexpr int kMostOffset_m = 1;  // between colour's camera and depth's
// Of a file, whatever comments it has: it is looked at before anything is parsed. The longest that any
// program writes have some KiB.
inline constexpr std::uintmax_t kMaxCalibrationBytes = 64u << 10;

struct Calibration {
  CameraModel camera;     // width and height hold for has_size only; else the images decide
  bool has_size = false;  // the source says which image size it is for
  double depth_units_per_metre = kTumDepthUnitsPerMetre;
  bool depth_scale_given = false;  // by the source or a flag; else the default above is a guess
  DepthCamera depth_camera;        // of depth that is not registered to colour
  bool readout_given = false;      // of the rolling shutter, 0 included; else a global shutter is a guess
  std::string guess;               // what of the numbers is one, in a sentence; empty where none is

  // As CameraModel::validate for colour images of this size, a depth scale within its range, and a depth
  // camera for which the same holds, at most kMostOffset_m from colour's.
  Status validate(int width, int height, int depth_width, int depth_height) const;
  // Of depth images of colour's size.
  Status validate(int width, int height) const { return validate(width, height, width, height); }

  // What was not said and is therefore assumed: a sentence each, with what to do if it is wrong. To be shown
  // to whoever runs a recorded sequence; empty when all was said.
  std::vector<std::string> assumptions() const;
};

// kNotFound, kDamaged (what is expected and where), kInvalidArgument (not a regular file, or larger than a
// calibration can be), kUnsupported for a lens that plvo does not know. On failure `calibration` is
// unchanged.
Status read_calibration(const std::filesystem::path& path, Calibration& calibration);

// The calibration that lies beside a recorded sequence: the first that is there of the names that people and
// programs use. calibration.txt, calibration.yaml and camera.yaml come before all others; the last are those
// of ScanNet's exports, intrinsic/intrinsic_depth.txt and intrinsic/intrinsic_color.txt (of images of one
// size; both cameras are read by scannet_cameras.hpp).
std::optional<std::filesystem::path> calibration_file_in(const std::filesystem::path& folder);

// tum-fr1, tum-fr2, tum-fr3 (the values the benchmark publishes), 7scenes (depth's camera as its page says,
// colour's a guess), kinect-v1-default. kNotFound lists the names.
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
