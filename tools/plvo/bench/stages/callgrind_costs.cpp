// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/stages/callgrind_costs.hpp"

#include <cctype>
#include <sstream>

namespace plvo::bench {
namespace {

// "(12) name" assigns a number to a name at its first occurrence; later "(12)" stands for the name.
std::string resolve(const std::string& text, std::map<std::string, std::string>& names) {
  const std::size_t end = text.find(')');
  if (text.empty() || text[0] != '(' || end == std::string::npos) return text;
  const std::string number = text.substr(0, end + 1);
  if (text.size() > end + 2) names[number] = text.substr(end + 2);
  return names[number];
}

// Reads the cost of a line "position cost …", whose position may be "*", "+3" or "-3".
bool read_cost(const std::string& line, std::uint64_t& cost) {
  const char first = line.empty() ? 'x' : line[0];
  if (first != '*' && first != '+' && first != '-' && std::isdigit(static_cast<unsigned char>(first)) == 0)
    return false;
  std::istringstream words(line);
  std::string position;
  return static_cast<bool>(words >> position >> cost);
}

}  // namespace

std::uint64_t CallgrindCosts::of(const std::string& name) const {
  std::uint64_t sum = 0;
  for (const auto& [function, cost] : inclusive)
    if (function.starts_with(name) && function.find("::{lambda") == std::string::npos) sum += cost;
  return sum;
}

CallgrindCosts read_callgrind(std::istream& file) {
  CallgrindCosts costs;
  std::map<std::string, std::string> names;
  std::string function;
  bool of_callee = false;  // the next cost line belongs to a call
  for (std::string line; std::getline(file, line);) {
    std::uint64_t cost = 0;
    if (line.starts_with("fn=")) {
      function = resolve(line.substr(3), names);
    } else if (line.starts_with("cfn=")) {
      (void)resolve(line.substr(4), names);
    } else if (line.starts_with("calls=")) {
      of_callee = true;
    } else if (read_cost(line, cost)) {
      costs.inclusive[function] += cost;
      if (!of_callee) costs.total += cost;
      of_callee = false;
    }
  }
  return costs;
}

}  // namespace plvo::bench
