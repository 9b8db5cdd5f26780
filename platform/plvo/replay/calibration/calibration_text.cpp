// SPDX-License-Identifier: Apache-2.0
// Reads and writes calibrations as plain text: numbers by their place, keys, or numbers followed by keys.
#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "plvo/camera/camera_info.hpp"
#include "plvo/replay/calibration/calibration_keys.hpp"

namespace plvo {
namespace {

using namespace calibration_form;
namespace fs = std::filesystem;

constexpr std::string_view kForm =
    "'fx fy cx cy [depth_scale [k1 k2 p1 p2 k3 [readout_s]]]', or the matrix fx 0 cx, 0 fy cy, 0 0 1, also "
    "of four rows and columns";

// Row by row: a 3×3 matrix, or a 4×4 matrix with the identity around the camera's entries.
bool is_camera_matrix(const std::vector<double>& m) {
  if (m.size() != 9 && m.size() != 16) return false;
  const std::size_t columns = m.size() == 9 ? 3 : 4;
  for (std::size_t i = 0; i < m.size(); ++i) {
    const std::size_t row = i / columns, column = i % columns;
    const bool of_camera = row < 2 && (column == row || column == 2);
    if (!of_camera && m[i] != (row == column ? 1 : 0)) return false;
  }
  return true;
}

bool is_of_depth_camera(const Key& key, const DepthCamera& depth) {
  return depth.known &&
         (key.kind == KeyKind::kDepthPlace || (key.kind == KeyKind::kDepthPinhole && !depth.as_colour));
}

// These are written together, if the timing of depth is known.
bool is_depth_timing(const Key& key) {
  return key.kind == KeyKind::kSensor && key.name.starts_with("depth_") && key.name != "depth_scale";
}

// Words without comments; ':', '=', ',' count as white space, like the brackets of a printed matrix.
std::vector<std::string_view> words_of(std::string_view content) {
  std::vector<std::string_view> words;
  while (!content.empty()) {
    std::string_view line = content.substr(0, content.find('\n'));
    content.remove_prefix(std::min(content.size(), line.size() + 1));
    line = line.substr(0, line.find('#'));
    constexpr std::string_view kSeparators = " \t\r:=,[];";
    for (std::size_t begin = 0; (begin = line.find_first_not_of(kSeparators, begin)) != line.npos;) {
      const std::size_t end = std::min(line.find_first_of(kSeparators, begin), line.size());
      words.push_back(line.substr(begin, end - begin));
      begin = end;
    }
  }
  return words;
}

}  // namespace

namespace calibration_form {

Status parse_text(const fs::path& path, std::string_view content, Calibration& calibration) {
  const std::vector<std::string_view> words = words_of(content);
  if (words.empty()) return damaged(path, fmt::format("is empty; expected {}", kForm));
  Collector collector(path);
  std::vector<double> values;
  for (double value = 0; values.size() < words.size() && parse_number(words[values.size()], value);)
    values.push_back(value);
  const std::size_t numbers = values.size();
  const bool known_word = numbers < words.size() && is_key(words[numbers]);
  if (numbers > 0 && numbers < words.size() && !known_word)
    return damaged(path, fmt::format("'{}' is not a number", words[numbers].substr(0, 40)));
  const bool matrix = is_camera_matrix(values);
  if (matrix) {
    const std::size_t columns = numbers == 9 ? 3 : 4;
    values = {values[0], values[columns + 1], values[2], values[columns + 2]};
  }
  if (!matrix && numbers != 0 && numbers != 4 && numbers != 5 && numbers != 10 && numbers != kPlaces)
    return damaged(path, fmt::format("has {} numbers; expected {}", numbers, kForm));
  for (std::size_t place = 0; place < values.size(); ++place) collector.set_place(place, values[place]);
  for (std::size_t i = numbers; i < words.size(); i += 2) {
    const std::string_view value = i + 1 < words.size() ? words[i + 1] : std::string_view();
    if (Status status = collector.set(words[i], value); !status.ok()) return status;
  }
  return collector.finish(calibration);
}

}  // namespace calibration_form

std::string calibration_text(const Calibration& calibration) {
  Numbers numbers;
  numbers.calibration = calibration;
  Numbers defaults;
  const auto is_default = [&](const Key& key) { return key.of(numbers) == key.of(defaults); };
  std::size_t places = 5;
  if (!calibration.camera.distortion.is_zero()) places = 10;
  if (calibration.readout_given) places = kPlaces;
  std::string text;
  for (std::size_t i = 0; i < places; ++i)
    text += fmt::format("{}{}", i == 0 ? "" : " ", keys()[i].of(numbers));
  for (const Key& key : keys().subspan(kPlaces)) {
    const bool timed = is_depth_timing(key) && calibration.camera.depth_timing.known;
    const bool of_depth = is_of_depth_camera(key, calibration.depth_camera);
    const bool others = key.kind == KeyKind::kSensor || key.kind == KeyKind::kLens;
    if (timed || of_depth || (others && !is_default(key)))
      text += fmt::format("\n{} {}", key.name, key.of(numbers));
  }
  const Distortion& lens = calibration.camera.distortion;
  if (!lens.is_plumb_bob()) text += fmt::format("\n{} {}", kLensModelKey, lens_model_name(lens));
  return text;
}

std::string calibration_lines(const Calibration& calibration) {
  Numbers numbers;
  numbers.calibration = calibration;
  numbers.width = calibration.camera.width;
  numbers.height = calibration.camera.height;
  const Distortion& lens = calibration.camera.distortion;
  const bool timed = calibration.camera.depth_timing.known;
  const auto written = [&](const Key& key) {
    if (key.kind == KeyKind::kSize) return calibration.has_size;
    if (key.kind == KeyKind::kDepthPinhole || key.kind == KeyKind::kDepthPlace)
      return is_of_depth_camera(key, calibration.depth_camera);
    if (is_depth_timing(key)) return timed;
    if (key.name == "stamp_sigma_s") return calibration.camera.stamp_sigma_s > 0;
    if (key.name == "readout_s") return calibration.readout_given;
    const bool of_pinhole = key.name == "fx" || key.name == "fy" || key.name == "cx" || key.name == "cy";
    const bool of_rational = key.name == "k4" || key.name == "k5" || key.name == "k6";
    return key.kind == KeyKind::kSensor || of_pinhole ||
           (of_rational ? !lens.is_plumb_bob() : !lens.is_zero());
  };
  std::string text;
  for (const Key& key : keys())
    if (written(key)) text += fmt::format("{}: {}\n", key.name, key.of(numbers));
  if (!lens.is_plumb_bob()) text += fmt::format("{}: {}\n", kLensModelKey, lens_model_name(lens));
  return text;
}

}  // namespace plvo
