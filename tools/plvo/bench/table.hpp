// SPDX-License-Identifier: Apache-2.0
// A table of text, written as Markdown, CSV or HTML.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace plvo::bench {

inline constexpr const char* kIdentity = "zero motion";
inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // shown as –

struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  // each as long as the header
  std::size_t text_columns = 1;                // the first ones; the others are numbers, set to the right
};

std::string to_markdown(const Table& table);
std::string to_csv(const Table& table);
// One self-contained page. notes: paragraphs below the table.
std::string to_html(const std::string& title, const Table& table, const std::vector<std::string>& notes);

// "–" for NaN.
std::string cell(double value, int decimals);

}  // namespace plvo::bench
