// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/index/numbered_index.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "plvo/host/number_text.hpp"
#include "plvo/replay/small_letters.hpp"

#include "plvo/host/files/reader_limits.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDigits = 8;
constexpr std::uintmax_t kMaxPoseBytes = 1u << 16;

enum class Ending : std::uint8_t { kImage, kJpeg, kImageButJpeg, kText };

// The names of one kind of file: folder/prefix NUMBER suffix .extension
struct Kind {
  std::string folder, prefix, suffix;
  Ending ending = Ending::kImage;
};
struct Layout {
  Kind colour, depth, pose;
  bool in_millimetres = false;  // unit of depth: certain by the definition of the layout, or only likely
  std::string unclear;          // why it cannot be read; else empty
};

using Numbered = std::map<std::uint32_t, std::string>;  // file relative to the sequence's folder

bool has_ending(std::string_view name, Ending ending) {
  if (ending == Ending::kText) return name.ends_with(".txt");
  return ends_as_image(name) && (ending == Ending::kImage || ends_as_jpeg(name) == (ending == Ending::kJpeg));
}

// The part of a name between prefix and suffix; empty for a name of another form, or one that begins with a
// dot.
std::optional<std::string> middle(const std::string& name, const Kind& kind) {
  if (name.starts_with('.') || !has_ending(name, kind.ending)) return {};
  const std::string stem = fs::path(name).stem().string();
  if (stem.size() < kind.prefix.size() + kind.suffix.size() || !stem.starts_with(kind.prefix) ||
      !stem.ends_with(kind.suffix))
    return {};
  return stem.substr(kind.prefix.size(), stem.size() - kind.prefix.size() - kind.suffix.size());
}

bool parse_frame_number(const std::string& text, std::uint32_t& number) {
  return text.size() <= kMaxDigits && parse_whole_text(text, number);
}

// Prefix and suffix around the only number in the names of images, and whether some images are JPEG and some
// are not.
struct Endings {
  bool jpeg = false, other = false;
};
using Forms = std::map<std::pair<std::string, std::string>, Endings>;

Forms forms_in(const fs::path& folder) {
  constexpr std::string_view kDigits = "0123456789";
  Forms forms;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.') || !ends_as_image(name)) continue;
    const std::string stem = entry->path().stem().string();
    const std::size_t first = stem.find_first_of(kDigits);
    if (first == stem.npos) continue;
    const std::size_t after = std::min(stem.find_first_not_of(kDigits, first), stem.size());
    if (stem.find_first_of(kDigits, after) != stem.npos) continue;
    Endings& endings = forms[{stem.substr(0, first), stem.substr(after)}];
    (ends_as_jpeg(name) ? endings.jpeg : endings.other) = true;
  }
  return forms;
}

struct Words {
  std::string_view colour, depth, pose;
};
constexpr auto kWords = std::to_array<Words>({{"color", "depth", "pose"},
                                              {"colour", "depth", "pose"},
                                              {"rgb", "depth", "pose"},
                                              {"Color", "Depth", "Pose"},
                                              {"Colour", "Depth", "Pose"},
                                              {"RGB", "Depth", "Pose"}});

std::string replaced(std::string text, std::size_t at, std::string_view word, std::string_view by) {
  return text.replace(at, word.size(), by);
}

// Layout with colour and depth in one folder: their names differ in a word, or, without one, in the image
// format.
std::optional<Layout> layout_of_one_folder(const fs::path& folder) {
  const Forms forms = forms_in(folder);
  for (const auto& [form, endings] : forms) {
    const auto& [prefix, suffix] = form;
    for (const Words& words : kWords) {
      Kind depth, pose;
      if (const std::size_t at = prefix.find(words.colour); at != prefix.npos) {
        depth = {"", replaced(prefix, at, words.colour, words.depth), suffix};
        pose = {"", replaced(prefix, at, words.colour, words.pose), suffix, Ending::kText};
      } else if (const std::size_t in = suffix.find(words.colour); in != suffix.npos) {
        depth = {"", prefix, replaced(suffix, in, words.colour, words.depth)};
        pose = {"", prefix, replaced(suffix, in, words.colour, words.pose), Ending::kText};
      } else {
        continue;
      }
      if (!forms.contains({depth.prefix, depth.suffix})) continue;
      const bool seven_scenes = prefix == "frame-" && suffix == ".color";
      return Layout{{"", prefix, suffix}, depth, pose, seven_scenes, {}};
    }
  }
  for (const auto& [form, endings] : forms)
    if (endings.jpeg && endings.other)
      return Layout{{"", form.first, form.second, Ending::kJpeg},
                    {"", form.first, form.second, Ending::kImageButJpeg},
                    {"pose", "", "", Ending::kText},
                    false,
                    {}};
  return {};
}

// Finds the folder whose name is one of these; else the only one whose name begins with one of them, in any
// case. Several candidates set `unclear`. Folders without numbered images do not count.
std::optional<Kind> folder_of(const fs::path& folder, std::span<const std::string_view> names,
                              std::string& unclear) {
  std::map<std::string, Kind> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    const std::string name = entry->path().filename().string();
    const bool fits = std::any_of(names.begin(), names.end(), [lower = in_small_letters(name)](auto word) {
      return lower.starts_with(word);
    });
    if (!fits || !entry->is_directory(ignored)) continue;
    const Forms forms = forms_in(entry->path());
    if (forms.empty()) continue;
    const auto& [prefix, suffix] = forms.begin()->first;
    found[name] = {name, prefix, suffix};
  }
  for (const std::string_view word : names)
    for (const auto& [name, kind] : found)
      if (in_small_letters(name) == word) return kind;
  if (found.empty()) return {};
  if (found.size() > 1)
    unclear = fmt::format("{} and {} may both be meant; name the right one {}", found.begin()->first,
                          found.rbegin()->first, names.front());
  return found.begin()->second;
}

// Layout with colour and depth in separate folders.
std::optional<Layout> layout_of_two_folders(const fs::path& folder) {
  constexpr auto kColour =
      std::to_array<std::string_view>({"color", "colour", "rgb", "image", "images", "img"});
  constexpr auto kDepth = std::to_array<std::string_view>({"depth"});
  Layout layout;
  const std::optional<Kind> colour = folder_of(folder, kColour, layout.unclear);
  const std::optional<Kind> depth = folder_of(folder, kDepth, layout.unclear);
  if (!colour || !depth) return {};
  layout.colour = *colour;
  layout.depth = *depth;
  layout.pose = {"pose", "", "", Ending::kText};
  const auto plain = [](const Kind& kind) { return kind.prefix.empty() && kind.suffix.empty(); };
  layout.in_millimetres =
      colour->folder == "color" && depth->folder == "depth" && plain(*colour) && plain(*depth);  // ScanNet
  return layout;
}

std::optional<Layout> layout_of(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / "rgb.txt", error) || fs::exists(folder / "associations.txt", error)) return {};
  const std::optional<Layout> layout = layout_of_two_folders(folder);
  return layout ? layout : layout_of_one_folder(folder);
}

// A missing folder yields no files.
Status list_files(const fs::path& folder, const Kind& kind, Numbered& files) {
  std::error_code error;
  for (fs::directory_iterator entry(folder / kind.folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const std::optional<std::string> digits = middle(name, kind);
    if (!digits) continue;
    const std::string file = (fs::path(kind.folder) / name).string();
    std::uint32_t number = 0;
    if (!parse_frame_number(*digits, number)) {
      return {
          StatusCode::kDamaged,
          fmt::format("{}: expected a number of at most {} digits in place of '{}'; a folder without rgb.txt "
                      "and associations.txt has numbered frames",
                      file, kMaxDigits, *digits)};
    }
    if (files.size() == kMostImages)
      return {StatusCode::kInvalidArgument,
              fmt::format("{} holds more than {} numbered frames, of which plvo reads no more; split it",
                          (folder / kind.folder).string(), kMostImages)};
    const auto [there, added] = files.emplace(number, file);
    if (!added) {
      return {StatusCode::kDamaged,
              fmt::format("{} and {} have the same number; keep one of them", std::min(there->second, file),
                          std::max(there->second, file))};
    }
  }
  if (!error || error == std::errc::no_such_file_or_directory) return {};
  return {StatusCode::kIo,
          fmt::format("cannot list {}: {}", (folder / kind.folder).string(), error.message())};
}

// Evenly omitted frames are no gaps; but where some are missing between others, a copy may be incomplete.
std::string gaps(const std::vector<std::uint32_t>& numbers) {
  std::uint32_t step = UINT32_MAX;
  for (std::size_t i = 1; i < numbers.size(); ++i) step = std::min(step, numbers[i] - numbers[i - 1]);
  std::size_t missing = 0;
  std::uint32_t first = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const std::uint32_t jump = (numbers[i] - numbers[i - 1]) / step;
    if (jump > 1 && missing == 0) first = numbers[i - 1] + step;
    missing += jump - 1;
  }
  if (missing == 0) return {};
  return fmt::format(
      "numbers without a pair of images between the frames {} and {}: {}, the first is {}; they are taken as "
      "gaps in time (if the images should be there, copy the recording again)",
      numbers.front(), numbers.back(), missing, first);
}

}  // namespace

bool is_numbered_folder(const fs::path& folder) { return layout_of(folder).has_value(); }

Status read_numbered_index(const fs::path& folder, double frames_per_s, SequenceIndex& index) {
  index = {};
  index.numbered = true;
  const Layout layout = layout_of(folder).value_or(Layout());
  if (!layout.unclear.empty())
    return {StatusCode::kInvalidArgument, fmt::format("{}: {}", folder.string(), layout.unclear)};
  index.in_millimetres = layout.in_millimetres;
  Numbered colour, depth, poses;
  Status status = list_files(folder, layout.colour, colour);
  if (status.ok()) status = list_files(folder, layout.depth, depth);
  if (status.ok()) status = list_files(folder, layout.pose, poses);
  if (!status.ok()) return status;
  const auto stamped = [frames_per_s](const auto& numbered) {
    return StampedFile{std::llround(numbered.first * 1e9 / frames_per_s), numbered.second};
  };
  std::vector<std::uint32_t> numbers;
  for (const auto& image : colour) {
    const auto partner = depth.find(image.first);
    if (partner == depth.end()) continue;
    index.pairs.push_back({stamped(image), stamped(*partner)});
    numbers.push_back(image.first);
  }
  for (const auto& pose : poses) index.poses.push_back(stamped(pose));
  index.unpaired_colour = colour.size() - index.pairs.size();
  index.unpaired_depth = depth.size() - index.pairs.size();
  if (index.pairs.empty())
    return {StatusCode::kInvalidArgument,
            fmt::format("{}: no colour image has a depth image of the same number", folder.string())};
  index.remark = gaps(numbers);
  return {};
}

Status read_matrix_pose(const fs::path& path, Se3& pose, bool& usable) {
  std::vector<TableRow> rows;
  const auto keep = [&rows](const TableRow& row) {
    rows.push_back(row);
    return Status();
  };
  if (Status status = each_row(path, kMaxPoseBytes, keep); !status.ok()) return status;
  std::vector<double> matrix;
  for (const TableRow& row : rows) {
    std::vector<double> numbers(4);
    if (row.words.size() != numbers.size()) break;
    if (Status status = parse_numbers(path, row, 0, numbers); !status.ok()) return status;
    matrix.insert(matrix.end(), numbers.begin(), numbers.end());
  }
  if (rows.size() != 4 || matrix.size() != 16)
    return {StatusCode::kDamaged, fmt::format("{}: expected four rows of four numbers", path.string())};
  usable = std::all_of(matrix.begin(), matrix.end(), [](double value) { return std::isfinite(value); });
  if (!usable) return {};
  if (matrix[12] != 0 || matrix[13] != 0 || matrix[14] != 0 || matrix[15] != 1)
    return row_error(path, rows[3], "the last row of a pose must be 0 0 0 1");
  return matrix_pose(path, rows[0], matrix, pose);
}

Status read_numbered_poses(const fs::path& folder, const std::vector<StampedFile>& files,
                           Trajectory& trajectory) {
  trajectory = {};
  for (const StampedFile& file : files) {
    StampedPose pose{file.stamp_ns, {}};
    bool usable = false;
    if (Status status = read_matrix_pose(folder / file.file, pose.T_world_camera, usable); !status.ok())
      return status;
    if (usable) {
      trajectory.poses.push_back(pose);
    } else {
      ++trajectory.ignored_rows;
    }
  }
  if (!trajectory.poses.empty()) return {};
  return {StatusCode::kInvalidArgument,
          fmt::format("{}: none of the {} pose files holds a pose", folder.string(), files.size())};
}

}  // namespace plvo
