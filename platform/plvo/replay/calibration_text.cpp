// SPDX-License-Identifier: Apache-2.0
// Calibrations as plain text: numbers by their place, keys, or numbers first and then keys; and the writer of
// the same.
#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "plvo/replay/calibration_keys.hpp"

namespace plvo {
namespace {

using namespace calibration_form;
namespace fs = std::filesystem;

constexpr std::string_view kForm = "'fx fy cx cy [depth_scale [k1 k2 p1 p2 k3 [readout_s]]]'";

// Words without comments; ':', '=', ',' count as white space.
std::vector<std::string_view> words_of(std::string_view content) {
  std::vector<std::string_view> words;
  while (!content.empty()) {
    std::string_view line = content.substr(0, content.find('\n'));
    content.remove_prefix(std::min(content.size(), line.size() + 1));
    line = line.substr(0, line.find('#'));
    constexpr std::string_view kSeparators = " \t\r:=,";
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
  std::size_t numbers = 0;
  for (double value = 0; numbers < words.size() && parse_number(words[numbers], value); ++numbers)
    if (numbers < kPlaces) collector.set_place(numbers, value);
  const bool known_word =
      numbers < words.size() &&
      std::any_of(keys().begin(), keys().end(), [&](const Key& key) { return key.name == words[numbers]; });
  if (numbers > 0 && numbers < words.size() && !known_word)
    return damaged(path, fmt::format("'{}' is not a number", words[numbers].substr(0, 40)));
  if (numbers != 0 && numbers != 4 && numbers != 5 && numbers != 10 && numbers != kPlaces)
    return damaged(path, fmt::format("has {} numbers; expected {}", numbers, kForm));
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
  for (const Key& key : keys().subspan(kPlaces))
    if (key.kind == KeyKind::kSensor && (calibration.camera.depth_timing.known || !is_default(key)))
      text += fmt::format("\n{} {}", key.name, key.of(numbers));
  return text;
}

std::string calibration_lines(const Calibration& calibration) {
  Numbers numbers;
  numbers.calibration = calibration;
  numbers.width = calibration.camera.width;
  numbers.height = calibration.camera.height;
  const bool lens = !calibration.camera.distortion.is_zero();
  const bool timed = calibration.camera.depth_timing.known;
  const auto written = [&](const Key& key) {
    if (key.kind == KeyKind::kSize) return calibration.has_size;
    if (key.name.starts_with("depth_") && key.name != "depth_scale") return timed;
    if (key.name == "readout_s") return calibration.readout_given;
    const bool of_pinhole = key.name == "fx" || key.name == "fy" || key.name == "cx" || key.name == "cy";
    return key.kind == KeyKind::kSensor || of_pinhole || lens;
  };
  std::string text;
  for (const Key& key : keys())
    if (written(key)) text += fmt::format("{}: {}\n", key.name, key.of(numbers));
  return text;
}

}  // namespace plvo
