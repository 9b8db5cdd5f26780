// SPDX-License-Identifier: Apache-2.0
// The keys of calibration files, in one table: each sets one number of a Calibration. A new property of the
// sensor only needs a row in the table. It can then be read (as a key in text and in YAML, and beside a ROS
// camera_info), and calibration_text() writes it. Internal to this folder.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "plvo/replay/calibration/calibration.hpp"

namespace plvo::calibration_form {

struct Numbers {
  Calibration calibration;
  double width = 0, height = 0;  // px
};

enum class KeyKind : std::uint8_t {
  kLens,          // a camera_info has its own words for these
  kSize,          // likewise
  kSensor,        // not part of a camera_info
  kDepthPinhole,  // likewise; all four keys, or none if the pinhole is that of colour
  kDepthPlace,    // likewise: position and orientation of the depth camera
};

struct Key {
  std::string_view name;
  KeyKind kind;
  double& (*of)(Numbers& numbers);
};

// All keys. The first kPlaces of them, in this order, are also the numbers of the form without keys.
std::span<const Key> keys();
inline constexpr std::size_t kPlaces = 11;
inline constexpr std::size_t kMaxKeys = 32;

// The only key whose value is a word: the name of the lens model, as in a camera_info.
inline constexpr std::string_view kLensModelKey = "distortion_model";
bool is_key(std::string_view name);  // one of keys(), or kLensModelKey

// Collects the content of a file, key by key, and builds a calibration from it.
class Collector {
 public:
  explicit Collector(const std::filesystem::path& path) : path_(path) {}

  // Returns kDamaged for a key that is not in the table, an invalid value, or a repeated key; kUnsupported
  // for an unknown lens model.
  Status set(std::string_view key, std::string_view value);
  void set_place(std::size_t place, double value);
  // Sets the lens of a format with other words than the keys.
  void set_lens(const Pinhole& pinhole, const Distortion& distortion);
  void set_guess(std::string guess) { numbers_.calibration.guess = std::move(guess); }
  // Builds the calibration, once fx, fy, cx and cy are all given.
  Status finish(Calibration& calibration);

 private:
  bool given(std::string_view key) const;
  Status finish_depth_camera(DepthCamera& depth) const;
  Status set_lens_model(std::string_view name);
  void put(std::size_t index, double value);

  std::filesystem::path path_;
  Numbers numbers_;
  std::string lens_model_;
  std::array<bool, kMaxKeys> given_{};
};

bool parse_number(std::string_view text, double& value);
Status damaged(const std::filesystem::path& path, std::string_view what);

// Parse the content of a text file and of a YAML file; `path` is for messages.
Status parse_text(const std::filesystem::path& path, std::string_view content, Calibration& calibration);
Status parse_yaml(const std::filesystem::path& path, const std::string& content, Calibration& calibration);

}  // namespace plvo::calibration_form
