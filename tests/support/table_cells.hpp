// SPDX-License-Identifier: Apache-2.0
// Reads the rows of tables in markdown.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace plvo::test {

// The cells of a row, "| a | b |", without what is around them.
inline std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells;
  std::stringstream stream(row);
  std::string cell;
  std::getline(stream, cell, '|');
  while (std::getline(stream, cell, '|')) {
    const std::size_t first = cell.find_first_not_of(' ');
    cells.push_back(first == std::string::npos ? ""
                                               : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
  }
  return cells;
}

}  // namespace plvo::test
