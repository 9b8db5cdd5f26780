// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/table.hpp"

#include <fmt/core.h>

#include <cmath>

namespace plvo::bench {
namespace {

std::string escape_html(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '&') {
      out += "&amp;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string csv_cell(const std::string& text) {
  if (text == "–") return {};
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

}  // namespace

std::string to_markdown(const Table& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::string out = "|";
    for (const std::string& text : cells) out += ' ' + text + " |";
    return out + '\n';
  };
  std::string out = line(table.header) + '|';
  for (std::size_t i = 0; i < table.header.size(); ++i) out += i < table.text_columns ? "---|" : "---:|";
  out += '\n';
  for (const auto& row : table.rows) out += line(row);
  return out;
}

std::string to_csv(const Table& table) {
  std::string out;
  const auto line = [&out](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) out += ',';
      out += csv_cell(cells[i]);
    }
    out += '\n';
  };
  line(table.header);
  for (const auto& row : table.rows) line(row);
  return out;
}

std::string to_html(const std::string& title, const Table& table, const std::vector<std::string>& notes) {
  std::string out = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>{0}</title>\n<style>"
      "body{{font:15px sans-serif;margin:1em}}div{{overflow-x:auto}}table{{border-collapse:collapse}}"
      "td,th{{padding:.25em .6em;border-bottom:1px solid #ccc;text-align:right;white-space:nowrap}}"
      ".t{{text-align:left}}</style></head><body>\n<h1>{0}</h1>\n<div><table>\n",
      escape_html(title));
  const auto line = [&](const std::vector<std::string>& cells, const char* tag) {
    out += "<tr>";
    for (std::size_t i = 0; i < cells.size(); ++i)
      out += fmt::format("<{0}{1}>{2}</{0}>", tag, i < table.text_columns ? " class=\"t\"" : "",
                         escape_html(cells[i]));
    out += "</tr>\n";
  };
  line(table.header, "th");
  for (const auto& row : table.rows) line(row, "td");
  out += "</table></div>\n";
  for (const std::string& note : notes) out += "<p>" + escape_html(note) + "</p>\n";
  return out + "</body></html>\n";
}

std::string cell(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "–";
}

}  // namespace plvo::bench
