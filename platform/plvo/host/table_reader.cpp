// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/table_reader.hpp"

#include <fmt/core.h>

#include <charconv>
#include <fstream>
#include <utility>

namespace plvo {

namespace fs = std::filesystem;

Status row_error(const fs::path& path, const TableRow& row, const std::string& what) {
  return {StatusCode::kDamaged, fmt::format("{} line {}: {}", path.string(), row.line, what)};
}

std::vector<TableRow> parse_table(std::istream& stream) {
  std::vector<TableRow> rows;
  std::string text;
  for (int line = 1; std::getline(stream, text); ++line) {
    TableRow row{line, {}, false};
    std::string word;
    for (char c : text.substr(0, text.find('#')) + ' ') {
      const bool separator = c == ' ' || c == '\t' || c == '\r' || c == ',';
      row.commas |= c == ',';
      if (!separator) word += c;
      if (separator && !word.empty()) row.words.push_back(std::exchange(word, {}));
    }
    if (!row.words.empty()) rows.push_back(std::move(row));
  }
  return rows;
}

Status read_table(const fs::path& path, std::vector<TableRow>& rows) {
  rows.clear();
  std::error_code error;
  std::ifstream stream(path);
  if (!stream || fs::is_directory(path, error))
    return {StatusCode::kNotFound, fmt::format("cannot read {}; name an existing file", path.string())};
  rows = parse_table(stream);
  return {};
}

Status parse_numbers(const fs::path& path, const TableRow& row, std::size_t first,
                     std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (first + i >= row.words.size())
      return row_error(
          path, row,
          fmt::format("has {} columns where {} are needed", row.words.size(), first + values.size()));
    const std::string& word = row.words[first + i];
    const char* begin = word.data() + (word[0] == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), values[i]);
    if (error != std::errc() || end != word.data() + word.size())
      return row_error(path, row, fmt::format("'{}' is not a number", word));
  }
  return {};
}

}  // namespace plvo
