// SPDX-License-Identifier: Apache-2.0
// Text files of numbers: one row a line, separated by spaces, tabs or commas, `#` comments. UTF-8 with or
// without a byte order mark, lines ended as Unix or Windows ends them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/host/files/reader_limits.hpp"

namespace plvo {

struct TableRow {
  int line = 0;                    // in the file, from 1
  std::vector<std::string> words;  // as written: a stamp has more digits than a double
  bool commas = false;
};

// The words of a line without its comment, and one more than kMostColumns at the most; row.line stays.
void split_row(std::string_view line, TableRow& row);

// Each row that has a word goes to `take`, whose first failure ends it and is returned. More than most_rows
// of them or kMostColumns in one are refused. Else as read_text_file. One row at a time: a file within its
// limit could otherwise become fifty times its size.
Status each_row(const std::filesystem::path& path, std::uintmax_t limit_bytes,
                const std::function<Status(const TableRow&)>& take, std::size_t most_rows = kMostRows);

// words[first … first+values.size()) as numbers. kDamaged, naming file and line, for what is not a number; a
// NaN is one.
Status parse_numbers(const std::filesystem::path& path, const TableRow& row, std::size_t first,
                     std::vector<double>& values);

Status row_error(const std::filesystem::path& path, const TableRow& row, const std::string& what);

}  // namespace plvo
