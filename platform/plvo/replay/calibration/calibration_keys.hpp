// SPDX-License-Identifier: Apache-2.0
// The names that calibration files use, in one table: which number of a Calibration each one sets. A new
// property of the sensor becomes readable (as a key in text and in YAML, and beside a ROS camera_info) and is
// written by calibration_text() when it gets a row there. Internal to this room.
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
  kLens,          // a camera_info says these in its own words
  kSize,          // likewise
  kSensor,        // what a camera_info does not know
  kDepthPinhole,  // likewise; all of it, or nothing where it is colour's
  kDepthPlace,    // likewise: where the depth camera is, and how it is turned
};

struct Key {
  std::string_view name;
  KeyKind kind;
  double& (*of)(Numbers& numbers);
};

// The first kPlaces of them, in this order, are also the numbers of the form without keys.
std::span<const Key> keys();
inline constexpr std::size_t kPlaces = 11;
inline constexpr std::size_t kMaxKeys = 32;

// The one key whose value is a word: the name of the lens's model, as in a camera_info.
inline constexpr std::string_view kLensModelKey = "distortion_model";
bool is_key(std::string_view name);  // one of keys(), or kLensModelKey

// Collects what a file says, key by key, and makes a calibration of it.
class Collector {
 public:
  explicit Collector(const std::filesystem::path& path) : path_(path) {}

  // kDamaged for a key that is not in the table, a value that is none, or a key said twice; kUnsupported for
  // a lens that is not known.
  Status set(std::string_view key, std::string_view value);
  void set_place(std::size_t place, double value);
  // Where other words than the keys say it.
  void set_lens(const Pinhole& pinhole, const Distortion& distortion);
  void set_guess(std::string guess) { numbers_.calibration.guess = std::move(guess); }
  // The calibration, once fx, fy, cx and cy are all there.
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

// The content of a text file and of a YAML file; `path` is for messages.
Status parse_text(const std::filesystem::path& path, std::string_view content, Calibration& calibration);
Status parse_yaml(const std::filesystem::path& path, const std::string& content, Calibration& calibration);

}  // namespace plvo::calibration_form
