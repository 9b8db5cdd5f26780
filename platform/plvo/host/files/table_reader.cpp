// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/table_reader.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "plvo/host/files/input_file.hpp"
#include "plvo/host/number_text.hpp"

namespace plvo {

namespace fs = std::filesystem;

void split_row(std::string_view line, TableRow& row) {
  constexpr std::string_view kBetween = " \t\r,";
  row.words.clear();
  line = line.substr(0, line.find('#'));
  row.commas = line.find(',') != std::string_view::npos;
  while (row.words.size() <= kMostColumns) {
    line.remove_prefix(std::min(line.find_first_not_of(kBetween), line.size()));
    if (line.empty()) return;
    row.words.emplace_back(line.substr(0, line.find_first_of(kBetween)));
    line.remove_prefix(row.words.back().size());
  }
}

Status row_error(const fs::path& path, const TableRow& row, const std::string& what) {
  return {StatusCode::kDamaged, fmt::format("{} line {}: {}", path.string(), row.line, what)};
}

Status each_row(const fs::path& path, std::uintmax_t limit_bytes,
                const std::function<Status(const TableRow&)>& take, std::size_t most_rows) {
  std::string content;
  Status status = read_text_file(path, limit_bytes, content);
  std::string_view rest = content;
  TableRow row;
  std::size_t rows = 0;
  while (status.ok() && !rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    ++row.line;
    split_row(line, row);
    if (row.words.empty()) continue;
    if (row.words.size() > kMostColumns)
      return row_error(path, row, fmt::format("has more than {} columns", kMostColumns));
    if (++rows > most_rows)
      return {StatusCode::kInvalidArgument,
              fmt::format("{} has more than {} rows, of which plvo reads no more; split it", path.string(),
                          most_rows)};
    status = take(row);
  }
  return status;
}

Status parse_numbers(const fs::path& path, const TableRow& row, std::size_t first,
                     std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (first + i >= row.words.size())
      return row_error(
          path, row,
          fmt::format("has {} columns where {} are needed", row.words.size(), first + values.size()));
    const std::string& word = row.words[first + i];
    if (!parse_whole_text(std::string_view(word).substr(word[0] == '+' ? 1 : 0), values[i]))
      return row_error(path, row, fmt::format("'{}' is not a number", word));
  }
  return {};
}

}  // namespace plvo
