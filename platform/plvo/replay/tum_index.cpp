// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/tum_index.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <tuple>

#include "plvo/host/stamp_text.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

Status damaged(const fs::path& list, int line, std::string_view what) {
  return {StatusCode::kDamaged, fmt::format("{} line {}: {}", list.filename().string(), line, what)};
}

// Stamps that run backwards or repeat are refused, not repaired: which of the two images is right, nobody can
// know.
Status check_order(const fs::path& list, int line, const StampedFile& next,
                   const std::vector<StampedFile>& files) {
  if (files.empty() || next.stamp_ns > files.back().stamp_ns) return {};
  const bool doubled = next.stamp_ns == files.back().stamp_ns;
  return damaged(list, line,
                 fmt::format("stamp {} {}; sort the list by stamp and keep each stamp once",
                             format_stamp(next.stamp_ns), doubled ? "appears twice" : "runs backwards"));
}

// `columns` pairs of stamp and file name a line, into one list per pair.
Status read_lists(const fs::path& list, int columns, std::vector<StampedFile>* lists) {
  std::ifstream stream(list);
  if (!stream) {
    return {
        StatusCode::kNotFound,
        fmt::format("cannot read {}; a sequence needs rgb.txt and depth.txt ('stamp file' per line), or an "
                    "associations.txt",
                    list.string())};
  }
  std::string text;
  for (int line = 1; std::getline(stream, text); ++line) {
    if (const std::size_t last = text.find_last_not_of(" \t\r"); last == std::string::npos || text[0] == '#')
      continue;
    std::istringstream words(text);
    for (int column = 0; column < columns; ++column) {
      std::string stamp;
      StampedFile next;
      words >> stamp >> next.file;
      if (next.file.empty() || !parse_stamp_ns(stamp, next.stamp_ns))
        return damaged(list, line,
                       columns == 1 ? "expected 'stamp file'" : "expected 'stamp rgb stamp depth'");
      if (Status status = check_order(list, line, next, lists[column]); !status.ok()) return status;
      lists[column].push_back(std::move(next));
    }
  }
  if (lists[0].empty())
    return {StatusCode::kInvalidArgument, fmt::format("{} lists no image", list.string())};
  return {};
}

Status pair_up(const std::vector<StampedFile>& colour, const std::vector<StampedFile>& depth,
               std::int64_t tolerance_ns, TumIndex& index) {
  const auto stamps = [](const std::vector<StampedFile>& files) {
    std::vector<std::int64_t> result;
    for (const StampedFile& file : files) result.push_back(file.stamp_ns);
    return result;
  };
  for (const auto& [c, d] : associate(stamps(colour), stamps(depth), tolerance_ns))
    index.pairs.push_back({colour[c], depth[d]});
  index.unpaired_colour = colour.size() - index.pairs.size();
  index.unpaired_depth = depth.size() - index.pairs.size();
  if (index.pairs.empty()) {
    return {StatusCode::kInvalidArgument,
            fmt::format(
                "no colour image has a depth image within {:.3f} s; are both lists of the same recording? "
                "(a larger --tolerance pairs more)",
                static_cast<double>(tolerance_ns) * 1e-9)};
  }
  return {};
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<std::int64_t>& first,
                                                           const std::vector<std::int64_t>& second,
                                                           std::int64_t tolerance_ns) {
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> candidates;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    while (begin < second.size() && second[begin] < first[i] - tolerance_ns) ++begin;
    for (std::size_t j = begin; j < second.size() && second[j] <= first[i] + tolerance_ns; ++j)
      candidates.emplace_back(std::abs(first[i] - second[j]), i, j);
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<char> first_used(first.size()), second_used(second.size());
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [difference, i, j] : candidates) {
    if (first_used[i] != 0 || second_used[j] != 0) continue;
    first_used[i] = second_used[j] = 1;
    pairs.emplace_back(i, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

Status read_tum_index(const fs::path& folder, const fs::path& associations, std::int64_t tolerance_ns,
                      TumIndex& index) {
  index = {};
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return {
        StatusCode::kNotFound,
        fmt::format("{} is not a folder; name the folder that holds rgb.txt and depth.txt", folder.string())};
  }
  std::vector<StampedFile> lists[2];
  fs::path joint = associations;
  if (joint.empty() && !fs::exists(folder / "rgb.txt", error) &&
      fs::exists(folder / "associations.txt", error))
    joint = folder / "associations.txt";
  if (!joint.empty()) {
    if (Status status = read_lists(joint, 2, lists); !status.ok()) return status;
    for (std::size_t i = 0; i < lists[0].size(); ++i) index.pairs.push_back({lists[0][i], lists[1][i]});
    return {};
  }
  if (Status status = read_lists(folder / "rgb.txt", 1, &lists[0]); !status.ok()) return status;
  if (Status status = read_lists(folder / "depth.txt", 1, &lists[1]); !status.ok()) return status;
  return pair_up(lists[0], lists[1], tolerance_ns, index);
}

}  // namespace plvo
