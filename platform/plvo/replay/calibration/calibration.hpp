// SPDX-License-Identifier: Apache-2.0
// Camera calibrations from files and by name. The format is recognised by its content (YAML also by the
// extensions .yaml, .yml and .json):
//   fx fy cx cy [depth_scale [k1 k2 p1 p2 k3 [readout_s]]]   numbers in this order; keys may follow
//   fx 0 cx  0 fy cy  0 0 1                                  the same as a matrix; also of four rows and
//                                                            columns, as ScanNet's are
//   fx: 525  (or fx = 525, or fx 525), one a line            keys in any order, those of
//                                                            calibration_keys.hpp
//   YAML with the same keys
//   ROS camera_info YAML                                     image_width, camera_matrix, the lens
//                                                            (camera_info.hpp)
//   YAML and JSON of Kalibr, EuRoC, ORB-SLAM and Open3D      other_programs.cpp
// The keys of the sensor may be added to the files of other programs. Missing properties are assumed, and
// reported: see assumptions().
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
inline constexpr int kMostOffset_m = 1;  // between the cameras of colour and depth
// Largest size of a file, with comments; it is checked before parsing. The longest files that programs write
// have some KiB.
inline constexpr std::uintmax_t kMaxCalibrationBytes = 64u << 10;

struct Calibration {
  CameraModel camera;     // width and height are valid only if has_size; else those of the images apply
  bool has_size = false;  // the source states the image size
  double depth_units_per_metre = kTumDepthUnitsPerMetre;
  bool depth_scale_given = false;  // by the source or a flag; else the default above is assumed
  DepthCamera depth_camera;        // of depth that is not registered to colour
  bool readout_given = false;      // of the rolling shutter, 0 included; else a global shutter is assumed
  std::string guess;               // which of the numbers are guessed, in a sentence; empty if none are

  // Validates like CameraModel::validate for colour images of this size. Also checks the range of the depth
  // scale, and a depth camera in the same way; it may be at most kMostOffset_m from that of colour.
  Status validate(int width, int height, int depth_width, int depth_height) const;
  // Does the same for depth images of the size of colour.
  Status validate(int width, int height) const { return validate(width, height, width, height); }

  // Lists what is missing and therefore assumed: a sentence each, with the remedy if it is wrong. Show them
  // to the user of a recorded sequence; empty if nothing is missing.
  std::vector<std::string> assumptions() const;
};

// Returns kNotFound, kDamaged (with the expected content and the position), kInvalidArgument (not a regular
// file, or larger than a calibration can be), kUnsupported for an unknown lens model. On failure
// `calibration` is unchanged.
Status read_calibration(const std::filesystem::path& path, Calibration& calibration);

// The calibration file of a recorded sequence: the first existing one of the common names. calibration.txt,
// calibration.yaml and camera.yaml come before all others. Last come those of ScanNet's exports,
// intrinsic/intrinsic_depth.txt and intrinsic/intrinsic_color.txt (for images of one size;
// scannet_cameras.hpp reads both cameras).
std::optional<std::filesystem::path> calibration_file_in(const std::filesystem::path& folder);

// Names: tum-fr1, tum-fr2, tum-fr3 (the values that the benchmark publishes), 7scenes (depth camera from its
// page, colour camera guessed), kinect-v1-default. The message of kNotFound lists the names.
Status builtin_calibration(std::string_view name, Calibration& calibration);
std::span<const std::string_view> builtin_calibration_names();

// Takes one of those names, or else a file for read_calibration.
Status named_calibration(const std::string& name_or_file, Calibration& calibration);

// Writes a calibration so that read_calibration restores it to the last bit: one line of numbers, without
// unneeded ones at its end, and a line `key value` for each other property of the sensor that is not at its
// default. The size is not written, because the images have it.
std::string calibration_text(const Calibration& calibration);

// Writes the same with a key on each line, `fx: 525`, which is valid as text and as YAML; includes the size,
// if there is one.
std::string calibration_lines(const Calibration& calibration);

}  // namespace plvo
