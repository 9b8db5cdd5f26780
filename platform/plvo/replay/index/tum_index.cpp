// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/index/tum_index.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <utility>

#include "plvo/host/files/input_file.hpp"
#include "plvo/host/files/reader_limits.hpp"
#include "plvo/host/files/stamp_text.hpp"
#include "plvo/replay/index/stamp_order.hpp"
#include "plvo/replay/index/stamp_pairs.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

Status damaged(const fs::path& list, int line, std::string_view what) {
  return {StatusCode::kDamaged, fmt::format("{} line {}: {}", list.filename().string(), line, what)};
}

std::vector<std::int64_t> stamps_of(const std::vector<StampedFile>& files) {
  std::vector<std::int64_t> stamps;
  stamps.reserve(files.size());
  for (const StampedFile& file : files) stamps.push_back(file.stamp_ns);
  return stamps;
}

// Stamps that run backwards or repeat are refused, not repaired: it is unknown which of the two images is
// right. lines: the line of each file in the list.
Status check_order(const fs::path& list, const std::vector<StampedFile>& files,
                   const std::vector<int>& lines) {
  const std::vector<std::int64_t> stamps = stamps_of(files);
  const std::optional<StampFault> fault = find_stamp_fault(stamps);
  return fault ? damaged(list, lines[fault->at], in_words(*fault, stamps)) : Status();
}

constexpr std::string_view kBlank = " \t\r";

std::string_view trim(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(kBlank), text.size());
  text.remove_prefix(begin);
  return text.substr(0, text.find_last_not_of(kBlank) + 1);
}

// Takes the next word off the front of the line.
std::string_view take_word(std::string_view& line) {
  line = trim(line);
  const std::string_view word = line.substr(0, line.find_first_of(kBlank));
  line.remove_prefix(word.size());
  return word;
}

// Takes a file's name off the front: all words up to the first one with the ending of an image, with the
// blanks between them. Without such an ending, it takes one word.
std::string take_name(std::string_view& line) {
  line = trim(line);
  const std::string_view whole = line;
  std::string_view rest = line;
  while (!trim(rest).empty()) {
    if (!ends_as_image(take_word(rest))) continue;
    line = rest;
    return std::string(whole.substr(0, whole.size() - rest.size()));
  }
  return std::string(take_word(line));
}

// Whether a part of the path is one of these folder names.
bool names(std::string_view path, std::initializer_list<std::string_view> folders) {
  for (const fs::path& part : fs::path(path))
    if (std::find(folders.begin(), folders.end(), part.string()) != folders.end()) return true;
  return false;
}

bool depth_first(const std::vector<StampedFile>& left, const std::vector<StampedFile>& right) {
  const auto all = [](const std::vector<StampedFile>& files,
                      std::initializer_list<std::string_view> folders) {
    return std::all_of(files.begin(), files.end(),
                       [&](const StampedFile& file) { return names(file.file, folders); });
  };
  return all(left, {"depth"}) && all(right, {"rgb", "color", "colour"});
}

// Reads `columns` pairs of stamp and file name from each line, into one list per column.
Status read_lists(const fs::path& list, int columns, std::vector<StampedFile>* lists) {
  std::string content;
  if (Status status = read_text_file(list, kMaxTextBytes, content); !status.ok()) {
    if (status.code() != StatusCode::kNotFound) return status;
    return {
        StatusCode::kNotFound,
        fmt::format("cannot read {}; a sequence needs rgb.txt and depth.txt, "
                    "associations.txt, or numbered images, as rgb/0.png and depth/0.png, or rgb_0.png and "
                    "depth_0.png (share/doc/plvo/user/recordings.md)",
                    list.string())};
  }
  std::vector<int> lines;
  std::string_view rest = content;
  for (int line = 1; !rest.empty(); ++line) {
    std::string_view text = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), text.size() + 1));
    text = trim(text);
    if (text.empty() || text.front() == '#') continue;
    for (int column = 0; column < columns; ++column) {
      StampedFile next;
      const std::string_view stamp = take_word(text);
      const bool is_stamp = parse_stamp_ns(stamp, next.stamp_ns);
      next.file = take_name(text);
      if (next.file.empty() || !is_stamp) {
        std::string what = columns == 1 ? "expected 'stamp file'" : "expected 'stamp rgb stamp depth'";
        if (!is_stamp && !stamp.empty()) what += "; " + stamp_error(stamp);
        return damaged(list, line, what);
      }
      if (next.file.size() > kMostNameBytes)
        return damaged(list, line, fmt::format("a name of more than {} bytes", kMostNameBytes));
      if (lists[column].size() == kMostImages)
        return {StatusCode::kInvalidArgument,
                fmt::format("{} lists more than {} images, of which plvo reads no more; split the recording",
                            list.string(), kMostImages)};
      lists[column].push_back(std::move(next));
    }
    lines.push_back(line);
  }
  for (int column = 0; column < columns; ++column)
    if (Status status = check_order(list, lists[column], lines); !status.ok()) return status;
  if (lists[0].empty())
    return {StatusCode::kInvalidArgument, fmt::format("{} lists no image", list.string())};
  return {};
}

// Moves the files of pairs out of the lists.
Status pair_up(std::vector<StampedFile>& colour, std::vector<StampedFile>& depth, std::int64_t tolerance_ns,
               SequenceIndex& index) {
  const std::vector<std::int64_t> colour_stamps = stamps_of(colour), depth_stamps = stamps_of(depth);
  index.pairs.reserve(std::min(colour.size(), depth.size()));
  for (const auto& [c, d] : associate(colour_stamps, depth_stamps, tolerance_ns))
    index.pairs.push_back({std::move(colour[c]), std::move(depth[d])});
  index.unpaired_colour = colour.size() - index.pairs.size();
  index.unpaired_depth = depth.size() - index.pairs.size();
  if (index.pairs.empty()) {
    return {
        StatusCode::kInvalidArgument,
        fmt::format("no colour image has a depth image within {:.3f} s (a larger --tolerance pairs more); {}",
                    static_cast<double>(tolerance_ns) * 1e-9, why_no_pair(colour_stamps, depth_stamps))};
  }
  index.remark = doubt_about_clocks(colour_stamps, depth_stamps);
  return {};
}

}  // namespace

Status read_tum_index(const fs::path& folder, const fs::path& associations, std::int64_t tolerance_ns,
                      SequenceIndex& index) {
  index = {};
  std::error_code error;
  std::vector<StampedFile> lists[2];
  fs::path joint = associations;
  if (joint.empty() && !fs::exists(folder / "rgb.txt", error) &&
      fs::exists(folder / "associations.txt", error))
    joint = folder / "associations.txt";
  if (!joint.empty()) {
    if (Status status = read_lists(joint, 2, lists); !status.ok()) return status;
    if (depth_first(lists[0], lists[1])) std::swap(lists[0], lists[1]);
    index.joint_list = true;
    if (const std::string doubt = stamp_unit_doubt(stamps_of(lists[0])); !doubt.empty())
      index.remark = "the stamps look wrong: " + doubt;
    index.pairs.reserve(lists[0].size());
    for (std::size_t i = 0; i < lists[0].size(); ++i)
      index.pairs.push_back({std::move(lists[0][i]), std::move(lists[1][i])});
    return {};
  }
  if (Status status = read_lists(folder / "rgb.txt", 1, &lists[0]); !status.ok()) return status;
  if (Status status = read_lists(folder / "depth.txt", 1, &lists[1]); !status.ok()) return status;
  return pair_up(lists[0], lists[1], tolerance_ns, index);
}

}  // namespace plvo
