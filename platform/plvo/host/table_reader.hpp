// SPDX-License-Identifier: Apache-2.0
// Text files of numbers: one row a line, separated by spaces, tabs or commas, `#` comments.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"

namespace plvo {

struct TableRow {
  int line = 0;                    // in the file, from 1
  std::vector<std::string> words;  // as written: a stamp has more digits than a double
  bool commas = false;
};

std::vector<TableRow> parse_table(std::istream& stream);
// kNotFound when the file cannot be read.
Status read_table(const std::filesystem::path& path, std::vector<TableRow>& rows);

// words[first … first+values.size()) as numbers. kDamaged, naming file and line, for what is not a number; a
// NaN is one.
Status parse_numbers(const std::filesystem::path& path, const TableRow& row, std::size_t first,
                     std::vector<double>& values);

Status row_error(const std::filesystem::path& path, const TableRow& row, const std::string& what);

}  // namespace plvo
